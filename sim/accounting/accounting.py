"""What a frame draws and costs, counted by the simulator for every policy alike."""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.machine.cost_terms.term import NO_CHANGES, Footprints, LevelChanges, Pass
from ...models.machine.frame_cost import FrameCost
from ...models.machine.price import Price
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from ...policies.view import View
from .switches import Drawn, Switches

_Rows: TypeAlias = tuple[NDArray[np.int64], FloatArray | None, FloatArray]
"""Rows, fractions and errors of what is drawn, as in `Drawn`."""


class Tally(NamedTuple):
    """What one frame counts and costs without noise, and its nodes in a cross-fade."""

    price: Price
    fading: int

    @property
    def gpu_ms(self) -> float:
        """Noise-free GPU time."""
        return self.price.gpu_ms


class Accounting:
    """Tables of one scene under one cost model, and the level history of its nodes."""

    def __init__(
        self,
        scene: Scene,
        costs: FrameCost,
        crossfade_ns: int,
        camera: Camera,
        visible_px: float,
        cameras: int = 1,
    ) -> None:
        levels = scene.types.levels
        self._scene, self._levels, self._costs = scene, levels, costs
        self._any_continuous = bool(levels.continuous.any())
        none = np.zeros(0, dtype=np.int64)
        self._rows: _Rows = (none, None, np.zeros(0))
        # Rows of frames in which nothing changes are the same array, and so is what they come to.
        self._row, self._full_row = none, none
        self._load = self._full_load = costs.load(none)
        self.viewport_px = float(camera.viewport_px)
        self._window_px = cameras * self.viewport_px
        # Where each camera draws, levels are drawn more often when nodes come into view of another.
        self._keeps_loads = costs.model.passes == 1
        self.switches = Switches(len(scene), levels, crossfade_ns, self.viewport_px, visible_px)

    def drawn(self, selection: Selection, view: View, *, repeats: bool = False) -> Drawn:
        """Return what a valid selection draws.

        `repeats` says that it is the same nodes at the same details as in the call before.
        """
        # A policy that draws all candidates hands the view's own ids back, and their projections
        # are there already.
        seen = view if selection.ids is view.ids else view.at(selection.ids)
        if not repeats:
            self._rows = self._place(seen, selection.detail)
        row, fraction, error_m = self._rows
        return Drawn(seen.ids, selection.detail, row, fraction, seen, error_m)

    def _place(self, seen: View, detail: FloatArray) -> _Rows:
        """Return row, fraction and error of each node's detail."""
        if self._any_continuous:
            row, fraction = self._levels.position(seen.type_index, detail)
            row = row.astype(np.int64)
            return row, fraction, self._levels.interpolate(self._levels.error_m, row, fraction)
        # A discrete detail is a whole number of levels below the finest: no search is needed.
        row = detail.astype(np.int64)
        row += seen.nodes.finest_row
        return row, None, self._levels.error_m.take(row)

    def full_gpu_ms(self, view: View, drawn: Drawn, tally: Tally, pixel_share: float) -> float:
        """Return the noise-free GPU time of a view's nodes at full detail: the visible load.

        `drawn` and `tally` are what the frame draws, at its share of the window's pixels.
        """
        alike = drawn.seen is view and not tally.fading and pixel_share == 1.0
        if alike and self._costs.level_by_level:
            return self._costs.finest_ms(tally.price)
        row = view.nodes.finest_row
        load = None
        if self._keeps_loads:
            if row is not self._full_row:
                self._full_row, self._full_load = row, self._costs.load(row)
            load = self._full_load
        return self._costs.frame(row, view, self._window_px, load=load).gpu_ms

    def tally(
        self,
        time_ns: int,
        drawn: Drawn,
        render_scale: float = 1.0,
        changes: LevelChanges = NO_CHANGES,
    ) -> Tally:
        """Return counts and noise-free GPU time, the old level of every cross-fade included.

        Shaded samples and the framebuffer's pixels go with the square of the render scale.
        """
        row, fraction = drawn.row, drawn.fraction
        seen: Footprints = drawn.seen
        at, old_row = self.switches.fading(time_ns, drawn.at)
        load = None
        if len(at):
            # Both levels are drawn at the same place.  The one that goes is drawn as its row, of a
            # continuous node a knot, since a toggle is told by rows.
            row = np.concatenate((row, old_row))
            seen = _DrawnTwice(seen, at)
            if fraction is not None:
                fraction = np.concatenate((fraction, np.zeros(len(at))))
        elif self._keeps_loads:
            if row is not self._row:
                self._row, self._load = row, self._costs.load(row, fraction)
            load = self._load
        price = self._costs.frame(
            row,
            seen,
            self._window_px,
            fraction=fraction,
            pixel_share=render_scale * render_scale,
            load=load,
            changes=changes,
        )
        return Tally(price, len(at))


class _DrawnTwice:
    """The footprint of nodes of which those at some positions stand once more behind the others."""

    __slots__ = ("_at", "_seen")

    def __init__(self, seen: Footprints, at: IntArray) -> None:
        self._seen, self._at = seen, at

    @property
    def area_px(self) -> FloatArray:
        return self._again(self._seen.area_px)

    @property
    def covered_px(self) -> FloatArray:
        return self._again(self._seen.covered_px)

    @property
    def inside_share(self) -> FloatArray:
        return self._again(self._seen.inside_share)

    @property
    def passes(self) -> tuple[Pass, ...]:
        return tuple(
            Pass(np.concatenate((drawn, drawn[self._at])), _DrawnTwice(part, self._at))
            for drawn, part in self._seen.passes
        )

    def _again(self, column: FloatArray) -> FloatArray:
        return np.concatenate((column, column[self._at]))
