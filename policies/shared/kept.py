"""What is the same of a frame's candidates as long as these stay, gathered once."""

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from ..view import View

T = TypeVar("T")


class Kept(Generic[T]):
    """A value that depends on a view's ids alone, made anew only where they are others.

    In three frames of four of a camera that walks the candidates are those of the frame before.
    """

    def __init__(self, gather: Callable[[View], T]) -> None:
        """Take how to make the value."""
        self._gather = gather
        self._nodes: object = None
        self._ids = np.zeros(0, dtype=np.int32)
        self._value: T | None = None

    def of(self, view: View) -> T:
        """Return the value for a view."""
        ids, last, value = view.ids, self._ids, self._value
        if value is not None and view.nodes is self._nodes:
            return value  # nodes keep what they gather themselves, and so are never others
        self._nodes = view.nodes
        # By their values, because an array may be a buffer that every frame is written into.
        if value is None or len(ids) != len(last) or (ids != last).any():
            value = self._value = self._gather(view)
            self._ids = ids.copy()
        return value
