"""Cells of a building and which of them can be seen from which: what walls hide.

Teller and Séquin, "Visibility preprocessing for interactive walkthroughs" (SIGGRAPH 1991): what
stands in a cell is potentially visible from another if some straight line leads there through
doors.  The sets are computed once; a frame looks up those of the camera's cell.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, freeze
from ...base.errors import InputError

EVERYWHERE = -1
"""Cell of a node that no wall hides."""


@dataclass(frozen=True, slots=True)
class Cells:
    """C cells that partly hide N nodes.

    Attributes
    ----------
    node_cell : (N,) int32
        Cell of each node, or `EVERYWHERE`.
    low_m, high_m : (C, 3) float64
        Boxes of the cells; a point in several belongs to the first.
    visible : (C + 1, C) bool
        Row c: cells of which something may be seen from cell c.  The last row is for cameras
        outside all cells.
    """

    node_cell: Annotated[IntArray, np.int32, "N"]
    low_m: Annotated[FloatArray, np.float64, "C", 3]
    high_m: Annotated[FloatArray, np.float64, "C", 3]
    visible: Annotated[BoolArray, np.bool_, "C + 1", "C"]
    _seen: dict[int, BoolArray] = field(
        init=False, repr=False, compare=False, default_factory=dict[int, BoolArray]
    )

    def __post_init__(self) -> None:
        n, c = len(self.node_cell), len(self.low_m)
        freeze(self, "cell", N=n, C=c)
        if c == 0:
            raise InputError("cells: expected at least one, got none")
        if n and (self.node_cell.min() < EVERYWHERE or self.node_cell.max() >= c):
            raise InputError(f"node_cell: expected -1 to {c - 1}, got values outside")
        if (self.low_m >= self.high_m).any():
            raise InputError("cell low_m: expected below high_m, got an empty box")
        if not self.visible[np.arange(c), np.arange(c)].all():
            raise InputError("cell visible: expected each cell to see itself")

    def cell_at(self, point_m: tuple[float, float, float]) -> int:
        """Return the cell of a point, or C outside all of them."""
        inside = ((self.low_m <= point_m) & (point_m <= self.high_m)).all(axis=1)
        return int(inside.argmax()) if inside.any() else len(self.low_m)

    def seen_from(self, point_m: tuple[float, float, float]) -> BoolArray:
        """Return which nodes walls do not hide from a point, (N,), read-only."""
        cell = self.cell_at(point_m)
        if cell not in self._seen:
            seen = self.visible[cell][self.node_cell] | (self.node_cell == EVERYWHERE)
            seen.flags.writeable = False
            self._seen[cell] = seen
        return self._seen[cell]
