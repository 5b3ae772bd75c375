"""Levels of detail of object types, as one table.

A discrete type has a chain of levels, finest first.  A continuous type has the same table read as
knots: at a resolution between two knots every count and the error are interpolated linearly.  So
the discretisation of a continuous type is its knots, and the resolution of a discrete level is its
share of the finest level's primitives.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import BoolArray, FloatArray, IntArray, derive, freeze, require_finite
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")
_SPLATS = LEVEL_PREDICTORS.index("splats")
_MOST = 2.0**53  # whole numbers up to this are exact; sums of what a damaged file holds overflow


def count_rows(rows: int, **counts: ArrayLike) -> FloatArray:
    """Return (rows, P) counts by predictor, each one value or (rows,); 0 where none is given."""
    table = np.zeros((rows, len(LEVEL_PREDICTORS)))
    for name, values in counts.items():
        table[:, LEVEL_PREDICTORS.index(name)] = values
    return table


@dataclass(frozen=True, slots=True)
class LevelTable:
    """Levels of K types, concatenated: type ``k`` owns rows ``start[k]`` to ``start[k + 1]``.

    Attributes
    ----------
    start : (K + 1,) int32
    counts : (L, P) float64
        Per level, in the order of `LEVEL_PREDICTORS`; never negative, never growing with
        coarseness in triangles and splats.
    error_m : (L,) float64
        Geometric error against the finest level in metres, before scale; never decreasing.
    bytes : (L,) float64
        Memory of the level's geometry.
    continuous : (K,) bool
        Whether the rows of a type are knots of a continuous model.
    resolution : (L,) float64
        Derived: primitives of the level over primitives of the finest level, in (0, 1].
    level_count : (K,) int32
        Derived: levels of each type.
    min_resolution : (K,) float64
        Derived: resolution of each type's coarsest level.
    type_of_level : (L,) int32
        Derived: the type that owns each row.
    """

    start: Annotated[IntArray, np.int32, "K + 1"]
    counts: Annotated[FloatArray, np.float64, "L", len(LEVEL_PREDICTORS)]
    error_m: Annotated[FloatArray, np.float64, "L"]
    bytes: Annotated[FloatArray, np.float64, "L"]
    continuous: Annotated[BoolArray, np.bool_, "K"]
    resolution: FloatArray = field(init=False)
    level_count: IntArray = field(init=False)
    min_resolution: FloatArray = field(init=False)
    type_of_level: IntArray = field(init=False)
    _key: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        types, levels = len(self.start) - 1, len(self.error_m)
        freeze(self, "level", K=types, L=levels)
        steps = np.diff(self.start)
        if types < 1 or self.start[0] != 0 or self.start[-1] != levels or (steps < 1).any():
            raise InputError("level start: expected every type to own at least one level")
        require_finite(self.error_m, "level error_m", low=0.0)
        for name in ("counts", "bytes"):
            require_finite(getattr(self, name), f"level {name}", low=0.0, high=_MOST)
        owner = np.repeat(np.arange(types, dtype=np.int32), steps)
        primitives = self.counts[:, _TRIANGLES] + self.counts[:, _SPLATS]
        self._require_ordered(primitives, owner)
        full = primitives[self.start[:-1]][owner]
        share = np.divide(primitives, full, out=np.ones(levels), where=full > 0)
        coarsest = share[self.start[1:] - 1]
        derive(self, resolution=share, level_count=steps, min_resolution=coarsest)
        # Ascending over the whole table: types two apart, coarseness within a type.
        derive(self, type_of_level=owner, _key=2.0 * owner + (1.0 - share))

    def _require_ordered(self, primitives: FloatArray, owner: IntArray) -> None:
        same = owner[1:] == owner[:-1]
        grows = same & (np.diff(primitives) > 0)
        better = same & (np.diff(self.error_m) < 0)
        if grows.any() or better.any():
            row = int(np.flatnonzero(grows | better)[0]) + 1
            raise InputError(
                f"levels of type {owner[row]}: expected finest first (primitives not growing, "
                f"error not falling), got {primitives[row]:g} primitives and error "
                f"{self.error_m[row]:g} m at level {row - int(self.start[owner[row]])}"
            )

    def rows_by_type(self) -> IntArray:
        """Return the rows of each type's levels, finest first, (K, W).

        W is the most levels that a type has; the last row of one that has fewer is repeated.
        """
        columns = np.arange(int(self.level_count.max()))
        return np.minimum(self.start[:-1, None] + columns, self.start[1:, None] - 1)

    def position(self, type_index: IntArray, detail: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return row and fraction of each (type, detail): a value is a lerp of rows i and i + 1.

        `detail` is a level index for discrete types and a resolution for continuous ones, both
        (m,); fractions of discrete types are 0.
        """
        row = self.start[type_index] + np.where(
            self.continuous[type_index], 0, np.nan_to_num(detail)
        ).astype(np.int32)
        fraction = np.zeros(len(row))
        soft = np.flatnonzero(self.continuous[type_index])
        if len(soft):
            kind = type_index[soft]
            key = 2.0 * kind + (1.0 - detail[soft])
            low = np.searchsorted(self._key, key, side="right") - 1
            low = np.clip(low, self.start[kind], np.maximum(self.start[kind + 1] - 2, 0))
            low = np.maximum(low, self.start[kind]).astype(np.int32)
            high = np.minimum(low + 1, self.start[kind + 1] - 1)
            width = self._key[high] - self._key[low]
            part = np.divide(key - self._key[low], width, out=np.zeros(len(low)), where=width > 0)
            row[soft] = low
            fraction[soft] = np.clip(part, 0.0, 1.0)
        return row, fraction

    def interpolate(self, column: FloatArray, row: IntArray, fraction: FloatArray) -> FloatArray:
        """Return values of a per-level `column`, (L,) or (L, P), at the result of `position`."""
        low = column[row]
        if not fraction.any():
            return low
        high = column[np.minimum(row + 1, len(column) - 1)]
        weight = fraction if column.ndim == 1 else fraction[:, None]
        return low + weight * (high - low)
