"""Switches of level, counted by the simulator in the same way for every policy.

A toggle is a change of level on a node drawn in this frame and in the one before.  A continuous
node toggles when its resolution passes a knot of its level table, its stated discretisation.  A
reversal is a toggle that returns, within `REVERSAL_NS`, to the level that the last toggle left.
Popping sums, over every change of detail, the change of projected error weighted by the share of
the viewport that the node covers, where several cameras look in the one of which it is most.  A
visible pop is a change of detail, between knots too, that changes the projected error by
`visible_px` or more: less is not seen.  A level is changed where a node is drawn at another level
than in the frame before, of a continuous one another collapse step.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.continuous.collapse_steps import CollapseSteps
from ...models.scene.levels import LevelTable
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
        Of these nodes.
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
    def at(self) -> NDArray[np.intp]:
        """The nodes as numpy indexes fastest, (m,)."""
        return self.seen.nodes.at


@dataclass(frozen=True, slots=True)
class SwitchCounts:
    """Switches of one frame."""

    toggles: int = 0
    reversals: int = 0
    popping_px: float = 0.0
    visible_pops: int = 0
    levels_changed: int = 0

    def __add__(self, other: "SwitchCounts") -> "SwitchCounts":
        return SwitchCounts(
            self.toggles + other.toggles,
            self.reversals + other.reversals,
            self.popping_px + other.popping_px,
            self.visible_pops + other.visible_pops,
            self.levels_changed + other.levels_changed,
        )


class Switches:
    """Level history of N nodes.

    Attributes
    ----------
    detail : (N,) float64
        Detail at which each node was last drawn, NaN before that.
    changed : (c,) intp
        Positions at which the last frame drew another detail than the node was last drawn at.
    """

    def __init__(
        self,
        nodes: int,
        levels: LevelTable,
        crossfade_ns: int,
        viewport_px: float,
        visible_px: float,
    ) -> None:
        self._steps = CollapseSteps(levels)
        self._crossfade_ns = crossfade_ns
        self._viewport_px, self._visible_px = viewport_px, visible_px
        # When each node was last drawn, but for those that the last frame draws, and at which row.
        self._frame = np.full(nodes, -2, dtype=np.int64)
        self._last_row = np.zeros(nodes, dtype=np.int64)
        self._row, self._ids = _NO_ROWS, _NOWHERE  # of the last frame
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
        self.changed = _NOWHERE

    def record(
        self, frame: int, time_ns: int, drawn: Drawn, changed: NDArray[np.intp] | None = None
    ) -> SwitchCounts:
        """Record what a frame draws, and return its switches; frames come one by one.

        `changed` are the positions whose details are not those of `detail`, if that is known.
        """
        ids, row = drawn.at, drawn.row
        if ids is not self._ids:
            return self._record_others(frame, time_ns, drawn, changed)
        # The same nodes as in the frame before.
        if row is self._row:
            self.changed = _NOWHERE
            return _NO_SWITCHES
        self._row = row
        at = self.changed = self._find_changed(drawn) if changed is None else changed
        return self._change(at, at, time_ns, drawn) if len(at) else _NO_SWITCHES

    def _record_others(
        self, frame: int, time_ns: int, drawn: Drawn, changed: NDArray[np.intp] | None
    ) -> SwitchCounts:
        """Record a frame that draws other nodes than the one before."""
        ids = drawn.at
        # Frames are kept where nodes come or go: all others were drawn for as long as these stayed.
        self._frame[self._ids] = frame - 1
        self._row, self._ids = drawn.row, ids
        at = self.changed = self._find_changed(drawn) if changed is None else changed
        # Drawn in the frame before, or it came into view, which is no switch.
        known = at[self._frame.take(ids.take(at)) == frame - 1]
        return self._change(at, known, time_ns, drawn) if len(at) else _NO_SWITCHES

    def _find_changed(self, drawn: Drawn) -> NDArray[np.intp]:
        return (drawn.seen.previous_detail != drawn.detail).nonzero()[0]

    def _change(
        self,
        at: NDArray[np.intp],
        known: NDArray[np.intp],
        time_ns: int,
        drawn: Drawn,
    ) -> SwitchCounts:
        """Take over details at some positions, and count those `known` from the frame before."""
        counts = self._switch(known, time_ns, drawn)
        ids = drawn.at.take(at)
        self._error_m[ids] = drawn.error_m.take(at)
        self._detail[ids] = drawn.detail.take(at)
        self._last_row[ids] = drawn.row.take(at)
        return counts

    def _switch(self, at: NDArray[np.intp], time_ns: int, drawn: Drawn) -> SwitchCounts:
        """Count the changes at positions `at` of what is drawn, since the frame before."""
        if not len(at):
            return _NO_SWITCHES
        ids = drawn.at.take(at)
        step = np.abs(drawn.error_m.take(at) - self._error_m.take(ids)) * drawn.seen.px_per_m_at(at)
        areas_px = [float(np.add.reduce(step * area.take(at))) for area in drawn.seen.areas_px]
        popping_px = max(areas_px) / self._viewport_px
        visible_pops = int(np.count_nonzero(step >= self._visible_px))
        new_row, old_row, levels_changed = drawn.row.take(at), self._last_row.take(ids), len(ids)
        if drawn.fraction is not None:
            kind, detail = drawn.seen.type_index.take(at), drawn.detail.take(at)
            level, old = self._steps.level(kind, detail), self._detail.take(ids)
            levels_changed = int(np.count_nonzero(level != self._steps.level(kind, old)))
            # Between two knots detail changes, and the picture with it, but no knot is passed.
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
        reversals = int(np.count_nonzero(undone))
        return SwitchCounts(len(ids), reversals, popping_px, visible_pops, levels_changed)

    def fading(
        self, time_ns: int, ids: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        """Return positions in `ids` of nodes still in a cross-fade, and the rows they leave."""
        if not self._crossfade_ns:
            return _NOWHERE, _NO_ROWS
        at = np.flatnonzero(self._fade_end_ns[ids] > time_ns)
        return at, self._fade_row[ids[at]]


_NO_SWITCHES = SwitchCounts()
_NOWHERE = np.empty(0, dtype=np.intp)
_NO_ROWS = np.empty(0, dtype=np.int64)
