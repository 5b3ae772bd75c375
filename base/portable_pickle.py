"""Pickles that other processes of this machine can load, whatever classes a user has made."""

import io
import pickle
import sys
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from types import FunctionType
from typing import Any

import cloudpickle

from .user_code import file_of, load_file

_OURS = f"{__name__.partition('.')[0]}."


def portable_pickle(
    value: object, buffer_callback: Callable[[pickle.PickleBuffer], Any] | None = None
) -> bytes:
    """Return the pickle of a value, which finds users' code wherever it is unpickled.

    A class or function of a user's file is found by its path, one of a module that can be imported
    by its name, and any other, as of a script, a notebook, a test or a function, travels by value.

    Parameters
    ----------
    buffer_callback
        Takes the arrays, which are then no part of the pickle (see `pickle.Pickler`).
    """
    buffer = io.BytesIO()
    pickler = _Pickler(buffer, protocol=5, buffer_callback=buffer_callback)
    try:
        pickler.dump(value)
    finally:
        for module in pickler.by_value:
            cloudpickle.unregister_pickle_by_value(module)
    return buffer.getvalue()


class _Pickler(cloudpickle.Pickler):
    """Decides how a class or function is named.

    Attributes
    ----------
    by_value : modules that had to be told to cloudpickle as such
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.by_value: list[Any] = []

    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, (type, FunctionType)):
            module = str(obj.__module__)
            file = file_of(module)
            if file is not None:
                return _find_in_file, (str(file), obj.__qualname__)
            if not _can_be_imported(module) and sys.modules[module] not in self.by_value:
                cloudpickle.register_pickle_by_value(sys.modules[module])
                self.by_value.append(sys.modules[module])
        pickler: Any = super()  # an untyped library
        return pickler.reducer_override(obj)


def _can_be_imported(name: str) -> bool:
    """Whether a module would be found by its name in a process with the same path.

    A test module that pytest loaded from a file is not, though it has a name.
    """
    if name.startswith(_OURS) or name == "__main__" or name not in sys.modules:
        return True  # of the last two cloudpickle knows better
    package, _, _ = name.rpartition(".")
    if package and not (package in sys.modules and _can_be_imported(package)):
        return False
    module = sys.modules[name]
    path = getattr(sys.modules[package], "__path__", None) if package else None
    for finder in sys.meta_path:
        spec = finder.find_spec(name, path)
        if spec is not None:
            file = getattr(module, "__file__", None)
            if file is not None:
                return spec.origin == file
            # A package without a file of its own, or built in.
            return list(spec.submodule_search_locations or ()) == list(
                getattr(module, "__path__", ())
            )
    return False


def _find_in_file(path: str, name: str) -> object:
    return attrgetter(name)(load_file(Path(path), "name"))
