"""Levels drawn for the first time: engines compile a pipeline for them and upload their geometry.

The commonest cause of stutter in the trackers of engines.  All resolutions of a continuous type
have one vertex buffer, and count as one level.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...models.scene.levels import LevelTable


class FirstUse(NamedTuple):
    """How many levels one frame draws for the first time, and the bytes of their geometry."""

    levels: int = 0
    bytes: float = 0.0


_NONE = FirstUse()


class FirstUses:
    """Which of the L levels of a table were drawn before."""

    def __init__(self, levels: LevelTable) -> None:
        self._bytes = levels.bytes
        self._owner = levels.start[:-1][levels.type_of_level]
        self._soft = levels.continuous[levels.type_of_level]
        self._any_soft = bool(self._soft.any())
        self._used = np.zeros(len(levels.bytes), dtype=np.bool_)

    def record(self, row: NDArray[np.int64]) -> FirstUse:
        """Record rows that a frame draws and the one before may not have drawn."""
        if not len(row):
            return _NONE
        if self._any_soft:
            row = np.where(self._soft.take(row), self._owner.take(row), row)
        row = row[~self._used.take(row)]
        if not len(row):
            return _NONE
        row = np.unique(row)
        self._used[row] = True
        return FirstUse(len(row), float(np.add.reduce(self._bytes.take(row))))
