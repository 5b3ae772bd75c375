"""What a frame draws and costs, counted by the simulator for every policy alike."""

from typing import NamedTuple

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...models.machine.cost_terms.term import Footprint
from ...models.machine.frame_cost import FrameCost
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from ...policies.view import View
from .switches import Drawn, Switches


class Tally(NamedTuple):
    """Counts of one frame by GPU predictor, its noise-free time, and nodes in a cross-fade."""

    counts: dict[str, float]
    gpu_ms: float
    fading: int


class Accounting:
    """Tables of one scene under one cost model, and the level history of its nodes."""

    def __init__(self, scene: Scene, costs: FrameCost, crossfade_ns: int, camera: Camera) -> None:
        levels = scene.types.levels
        self._scene, self._levels, self._costs = scene, levels, costs
        self._any_continuous = bool(levels.continuous.any())
        self._finest = levels.start[:-1].astype(np.int64)
        self.viewport_px = float(camera.viewport_px)
        self.switches = Switches(len(scene), crossfade_ns, self.viewport_px)

    def drawn(self, selection: Selection, view: View) -> Drawn:
        """Return what a valid selection draws."""
        # A policy that draws all candidates hands the view's own ids back, and their projections
        # are there already.
        seen = view if selection.ids is view.ids else view.at(selection.ids)
        detail, fraction = selection.detail, None
        if self._any_continuous:
            row, fraction = self._levels.position(seen.type_index, detail)
            row = row.astype(np.int64)
            error_m = self._levels.interpolate(self._levels.error_m, row, fraction)
        else:
            # A discrete detail is a whole number of levels below the finest: no search is needed.
            row = self._finest.take(seen.type_index)
            row += detail.astype(np.int64)
            error_m = self._levels.error_m.take(row)
        # In place: three temporary arrays a frame are what this function would take most time for.
        px_per_m = self._scene.scale.take(seen.ids)
        px_per_m *= view.camera.focal_px
        px_per_m /= seen.nearest_m
        return Drawn(seen.ids, detail, row, fraction, seen, error_m, px_per_m)

    def full_gpu_ms(self, view: View) -> float:
        """Return the noise-free GPU time of a view's nodes at full detail: the visible load."""
        return self._costs.frame(self._finest.take(view.type_index), view, self.viewport_px).gpu_ms

    def tally(self, time_ns: int, drawn: Drawn, render_scale: float = 1.0) -> Tally:
        """Return counts and noise-free GPU time, the old level of every cross-fade included.

        Shaded samples and the framebuffer's pixels go with the square of the render scale.
        """
        row, fraction, seen = drawn.row, drawn.fraction, drawn.seen
        at, old_row = self.switches.fading(time_ns, drawn.ids)
        if len(at):
            # Both levels are drawn at the same place.  The one that goes is drawn as its row, of a
            # continuous node a knot, since a toggle is told by rows.
            row = np.concatenate((row, old_row))
            seen = _DrawnTwice(seen, at)
            if fraction is not None:
                fraction = np.concatenate((fraction, np.zeros(len(at))))
        price = self._costs.frame(
            row, seen, self.viewport_px, fraction=fraction, pixel_share=render_scale * render_scale
        )
        return Tally(self._costs.counts(price), price.gpu_ms, len(at))


class _DrawnTwice:
    """The footprint of nodes of which those at some positions stand once more behind the others."""

    __slots__ = ("_at", "_seen")

    def __init__(self, seen: Footprint, at: IntArray) -> None:
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

    def _again(self, column: FloatArray) -> FloatArray:
        return np.concatenate((column, column[self._at]))
