"""Discrete levels for policies that choose resolutions."""

import numpy as np

from ..models.arrays import FloatArray, IntArray
from ..models.levels import LevelTable

__all__ = ["nearest_level"]


def nearest_level(levels: LevelTable, type_index: IntArray, resolution: FloatArray) -> FloatArray:
    """Return the finest level whose resolution is at most the wanted one, else the coarsest, (m,).

    So a level never has more primitives than were wanted, unless its type has none so coarse.
    """
    # Ascending over the whole table: types two apart, coarseness within a type.
    key = 2.0 * levels.type_of_level + (1.0 - levels.resolution)
    row = np.searchsorted(key, 2.0 * type_index + (1.0 - resolution), side="left")
    coarsest = levels.level_count[type_index] - 1
    return np.clip(row - levels.start[type_index], 0, coarsest).astype(np.float64)
