"""Discrete levels for policies that choose resolutions, and the reverse.

The discretisation of a continuous type is the knots of its level table.
"""

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.scene.levels import LevelTable


def detail_of_level(levels: LevelTable, type_index: IntArray, level: FloatArray) -> FloatArray:
    """Return what a selection calls a level: its index, or the resolution of a knot, (m,)."""
    if not levels.continuous.any():
        return level
    resolution = levels.resolution[levels.start[type_index] + level.astype(np.int32)]
    return np.where(levels.continuous[type_index], resolution, level)


def level_of_detail(levels: LevelTable, type_index: IntArray, detail: FloatArray) -> FloatArray:
    """Return the level index of each detail, between knots that of the coarser; NaN stays, (m,)."""
    if not levels.continuous.any():
        return detail
    soft = levels.continuous[type_index] & np.isfinite(detail)
    level = detail.copy()
    level[soft] = nearest_level(levels, type_index[soft], detail[soft])
    return level


def nearest_level(levels: LevelTable, type_index: IntArray, resolution: FloatArray) -> FloatArray:
    """Return the finest level whose resolution is at most the wanted one, else the coarsest, (m,).

    So a level never has more primitives than were wanted, unless its type has none so coarse.
    """
    # Ascending over the whole table: types two apart, coarseness within a type.
    key = 2.0 * levels.type_of_level + (1.0 - levels.resolution)
    row = np.searchsorted(key, 2.0 * type_index + (1.0 - resolution), side="left")
    coarsest = levels.level_count[type_index] - 1
    return np.clip(row - levels.start[type_index], 0, coarsest).astype(np.float64)
