"""Functions of OpenGL that moderngl lacks, called where the context's loader says that they are."""

from collections.abc import Callable
from ctypes import CFUNCTYPE
from typing import Any, TypeAlias

Loader: TypeAlias = Callable[[str], int]
"""Returns the address of a function of OpenGL by its name."""


def gl_function(load: Loader, name: str, result: Any, *arguments: Any) -> Callable[..., Any]:
    """Return a function of OpenGL, its result and arguments being types of ctypes.

    A loader may return an address for what the driver does not have: ask for its version or its
    extensions before.
    """
    return CFUNCTYPE(result, *arguments)(load(name))
