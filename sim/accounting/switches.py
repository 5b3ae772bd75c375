"""Switches of level, counted by the simulator in the same way for every policy.

A toggle is a change of level on a node drawn in this frame and in the one before.  A continuous
node toggles when its resolution passes a knot of its level table, its stated discretisation.  A
reversal is a toggle that returns, within `REVERSAL_NS`, to the level that the last toggle left.
Popping sums, over every change of detail, the change of projected error weighted by the share of
the viewport that the node covers.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...policies.view import View

REVERSAL_NS = 500_000_000
"""A switch undone within half a second is a reversal (three.js issue 14565 is the complaint)."""


@dataclass(slots=True)
class Drawn:
    """Nodes drawn in one frame, as equal-length arrays.

    Attributes
    ----------
    ids : int32
    detail : float64
    row : int64
        Row of the level table; with `fraction`, where between it and the next row.
    fraction : float64 or None
        None where every drawn node is discrete.
    seen : View
        Of these nodes; `area_px` is its.
    error_m : float64
        Geometric error of the level, before scale.
    """

    ids: IntArray
    detail: FloatArray
    row: NDArray[np.int64]
    fraction: FloatArray | None
    seen: View
    error_m: FloatArray

    @property
    def px_per_m(self) -> FloatArray:
        """Error in px of one metre of error before scale, at each node's nearest point, (m,)."""
        return self.seen.px_per_m

    @property
    def area_px(self) -> FloatArray:
        """Projected area of each node's bounding sphere, (m,)."""
        return self.seen.area_px

    @property
    def at(self) -> NDArray[np.intp]:
        """The nodes as numpy indexes fastest, (m,)."""
        return self.seen.nodes.at


@dataclass(frozen=True, slots=True)
class SwitchCounts:
    """Switches of one frame."""

    toggles: int = 0
    reversals: int = 0
    popping_px: float = 0.0

    def __add__(self, other: "SwitchCounts") -> "SwitchCounts":
        return SwitchCounts(
            self.toggles + other.toggles,
            self.reversals + other.reversals,
            self.popping_px + other.popping_px,
        )


class Switches:
    """Level history of N nodes.

    Attributes
    ----------
    detail : (N,) float64
        Detail at which each node was last drawn, NaN before that.
    """

    def __init__(self, nodes: int, crossfade_ns: int, viewport_px: float) -> None:
        self._crossfade_ns = crossfade_ns
        self._viewport_px = viewport_px
        # Frame and row of the last drawing in one number, so that one comparison tells the many
        # nodes that go on unchanged from the few that do not.
        self._stamp = np.full(nodes, -2 << _ROW_BITS, dtype=np.int64)
        self._row, self._ids = _NO_ROWS, _NOWHERE  # of the last frame
        self._behind = False  # whether stamps were left behind since then
        # No row is -1: what has never toggled cannot return.
        self._from_row = np.full(nodes, -1, dtype=np.int32)
        self._switch_ns = np.full(nodes, -REVERSAL_NS - 1, dtype=np.int64)
        self._error_m = np.zeros(nodes)
        # Without cross-fades nothing is kept for them.
        fading = nodes if crossfade_ns else 0
        self._fade_end_ns = np.zeros(fading, dtype=np.int64)
        self._fade_row = np.zeros(fading, dtype=np.int64)
        self._detail = np.full(nodes, np.nan)
        self.detail = self._detail.view()
        self.detail.flags.writeable = False

    def record(self, frame: int, time_ns: int, drawn: Drawn) -> SwitchCounts:
        """Record what a frame draws, and return its switches; frames come one by one."""
        ids, row = drawn.at, drawn.row
        if ids is self._ids:
            # Stamps are left as they are for as long as the nodes stay.
            self._behind = True
            if row is self._row:
                return _NO_SWITCHES
            at = self._differs(row != self._row, drawn)
            known, old_row = at, self._row.take(at)
        else:
            before = self._exchange(frame, ids, row)
            at = self._differs(before != row + ((frame - 1) << _ROW_BITS), drawn)
            before = before.take(at)
            # Drawn in the frame before, or it came into view, which is no switch.
            stays = before >> _ROW_BITS == frame - 1
            known, old_row = at[stays], before[stays] & _ROW_MASK
        self._row, self._ids = row, ids
        if not len(at):
            return _NO_SWITCHES
        counts = self._switch(known, old_row, time_ns, drawn)
        changed = ids.take(at)
        self._error_m[changed] = drawn.error_m.take(at)
        self._detail[changed] = drawn.detail.take(at)
        return counts

    def _exchange(
        self, frame: int, ids: NDArray[np.intp], row: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Stamp what a frame draws, and return the stamps that were there."""
        if self._behind:
            self._stamp[self._ids] = self._row + ((frame - 1) << _ROW_BITS)
            self._behind = False
        before = self._stamp.take(ids)
        self._stamp[ids] = row + (frame << _ROW_BITS)
        return before

    def _differs(self, other: BoolArray, drawn: Drawn) -> NDArray[np.intp]:
        """Return positions of nodes whose rows are others, or whose details are."""
        if drawn.fraction is not None:
            # The same row at another fraction pops too.
            other |= self._detail.take(drawn.at) != drawn.detail
        return other.nonzero()[0]

    def _switch(
        self, at: NDArray[np.intp], old_row: NDArray[np.int64], time_ns: int, drawn: Drawn
    ) -> SwitchCounts:
        """Count the changes at positions `at` of what is drawn, from rows `old_row`."""
        if not len(at):
            return _NO_SWITCHES
        ids = drawn.at.take(at)
        step = np.abs(drawn.error_m.take(at) - self._error_m.take(ids)) * drawn.px_per_m.take(at)
        popping_px = float(np.add.reduce(step * drawn.area_px.take(at))) / self._viewport_px
        new_row = drawn.row.take(at)
        if drawn.fraction is not None:
            # Between two knots detail changes, and the picture with it, but no level is switched.
            passed = old_row != new_row
            ids, new_row, old_row = ids[passed], new_row[passed], old_row[passed]
        # Both before they are overwritten by this toggle.
        undone = self._from_row.take(ids) == new_row
        undone &= time_ns - self._switch_ns.take(ids) <= REVERSAL_NS
        self._from_row[ids] = old_row
        self._switch_ns[ids] = time_ns
        if self._crossfade_ns:
            self._fade_row[ids] = old_row
            self._fade_end_ns[ids] = time_ns + self._crossfade_ns
        return SwitchCounts(len(ids), int(np.count_nonzero(undone)), popping_px)

    def fading(
        self, time_ns: int, ids: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        """Return positions in `ids` of nodes still in a cross-fade, and the rows they leave."""
        if not self._crossfade_ns:
            return _NOWHERE, _NO_ROWS
        at = np.flatnonzero(self._fade_end_ns[ids] > time_ns)
        return at, self._fade_row[ids[at]]


_NO_SWITCHES = SwitchCounts()
_ROW_BITS = 31
_ROW_MASK = (1 << _ROW_BITS) - 1
_NOWHERE = np.empty(0, dtype=np.intp)
_NO_ROWS = np.empty(0, dtype=np.int64)
