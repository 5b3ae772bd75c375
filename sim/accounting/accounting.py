"""What a frame draws, costs and shows, counted by the simulator for every policy alike."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.predictors import FRAMEBUFFER_PIXELS, SHADED_SAMPLES, STATE_CHANGES
from ...models.machine.cost import CostModel, rasterized_triangles
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from ...policies.view import View
from .switches import Drawn, Switches


@dataclass(frozen=True, slots=True)
class Tally:
    """Counts of one frame: level predictors in order, then those of the view, and its time."""

    level_counts: FloatArray
    shaded_samples: float
    rasterized_triangles: float
    state_changes: int
    gpu_ms: float
    fading: int


class Accounting:
    """Tables of one scene under one cost model, and the level history of its nodes."""

    def __init__(self, scene: Scene, costs: CostModel, crossfade_ns: int, camera: Camera) -> None:
        levels = scene.types.levels
        self._scene, self._levels, self._costs = scene, levels, costs
        self._any_continuous = bool(levels.continuous.any())
        self._finest = levels.start[:-1].astype(np.int64)
        self._level_ms, self._geometry = costs.level_ms(levels)
        self.viewport_px = float(camera.viewport_px)
        linear: list[float] = costs.linear_ms.tolist()
        self._sample_ms, self._change_ms = linear[SHADED_SAMPLES], linear[STATE_CHANGES]
        self._framebuffer_ms = self.viewport_px * linear[FRAMEBUFFER_PIXELS]
        self.switches = Switches(len(scene), crossfade_ns, self.viewport_px)

    def drawn(self, selection: Selection, view: View) -> Drawn:
        """Return what a valid selection draws."""
        seen = view if selection.ids is view.ids else view.at(selection.ids)
        detail, fraction = selection.detail, None
        if self._any_continuous:
            row, fraction = self._levels.position(seen.type_index, detail)
            row = row.astype(np.int64)
            error_m = self._levels.interpolate(self._levels.error_m, row, fraction)
        else:
            row = self._finest.take(seen.type_index)
            row += detail.astype(np.int64)
            error_m = self._levels.error_m.take(row)
        px_per_m = self._scene.scale.take(seen.ids)
        px_per_m *= view.camera.focal_px
        px_per_m /= seen.nearest_m
        reach = self._reach(seen)
        return Drawn(seen.ids, detail, row, fraction, seen.area_px, error_m, px_per_m, reach)

    def full_gpu_ms(self, view: View) -> float:
        """Return the noise-free GPU time of a view's nodes at full detail: the visible load."""
        row, area_px = self._finest.take(view.type_index), view.area_px
        samples, reach = float(area_px.sum()), self._reach(view)
        return self._price(self._times_drawn(row, None), row, None, area_px, reach, samples, 1.0)[2]

    def tally(self, time_ns: int, drawn: Drawn, render_scale: float = 1.0) -> Tally:
        """Return counts and noise-free GPU time, the old level of every cross-fade included.

        Shaded samples and the framebuffer's pixels go with the square of the render scale.
        """
        row, fraction, area_px, reach = drawn.row, drawn.fraction, drawn.area_px, drawn.reach
        at, old_row = self.switches.fading(time_ns, drawn.ids)
        if len(at):
            row = np.concatenate((row, old_row))
            area_px = np.concatenate((area_px, area_px[at]))
            if reach is not None:
                covered_px, inside = (np.concatenate((column, column[at])) for column in reach)
                reach = covered_px, inside
            if fraction is not None:
                fraction = np.concatenate((fraction, np.zeros(len(at))))
        pixel_share = render_scale * render_scale
        if pixel_share != 1.0:
            area_px = pixel_share * area_px
            reach = None if reach is None else (pixel_share * reach[0], reach[1])
        times_drawn, samples = self._times_drawn(row, fraction), float(area_px.sum())
        changes, reached, ms = self._price(
            times_drawn, row, fraction, area_px, reach, samples, pixel_share
        )
        # Sums here and in scores do without BLAS, whose threads add up in an order of their own.
        counts = np.einsum("l,lp->p", times_drawn, self._levels.counts)
        return Tally(counts, samples, reached, changes, ms, len(at))

    def _reach(self, seen: View) -> tuple[FloatArray, FloatArray] | None:
        """Return what rasterized triangles are counted by, None where they cost nothing."""
        return (seen.covered_px, seen.inside_share) if self._costs.rasterized_ms else None

    def _price(
        self,
        times_drawn: FloatArray,
        row: NDArray[np.int64],
        fraction: FloatArray | None,
        area_px: FloatArray,
        reach: tuple[FloatArray, FloatArray] | None,
        samples: float,
        pixel_share: float,
    ) -> tuple[int, float, float]:
        """Return state changes, triangles that reach a sample (NaN if free), and milliseconds."""
        costs = self._costs
        changes = int(np.count_nonzero(np.add.reduceat(times_drawn, self._finest)))
        ms = costs.base_ms + float((times_drawn * self._level_ms).sum())
        ms += samples * self._sample_ms + pixel_share * self._framebuffer_ms
        ms += changes * self._change_ms
        if not costs.has_roofline and reach is None:
            return changes, np.nan, ms
        geometry = self._geometry.take(row, axis=0)
        if fraction is not None:
            geometry = self._levels.interpolate(self._geometry, row, fraction)
        if costs.has_roofline:
            pixels = area_px * costs.roofline_ms[SHADED_SAMPLES]
            ms += float(np.maximum(geometry[:, 0], pixels).sum())
        if reach is None:
            return changes, np.nan, ms
        reached = float(rasterized_triangles(geometry[:, 1], *reach).sum())
        return changes, reached, ms + reached * costs.rasterized_ms

    def _times_drawn(self, row: NDArray[np.int64], fraction: FloatArray | None) -> FloatArray:
        """Return how many times each level is drawn, shared between the two about a resolution."""
        count = len(self._levels.error_m)
        if fraction is None:
            return np.bincount(row, minlength=count).astype(np.float64)
        # numpy's stubs say that bincount returns integers with weights too.
        low: Any = np.bincount(row, 1.0 - fraction, count)
        high: Any = np.bincount(np.minimum(row + 1, count - 1), fraction, count)
        return low + high
