"""What a frame draws, costs and shows, counted by the simulator for every policy alike."""

from dataclasses import dataclass

import numpy as np

from ..models.arrays import FloatArray, IntArray
from ..models.camera import Camera
from ..models.cost import CostModel
from ..models.predictors import (
    FRAMEBUFFER_PIXELS,
    LEVEL_PREDICTORS,
    SHADED_SAMPLES,
    STATE_CHANGES,
)
from ..models.scene import Scene
from ..policies.selection import Selection
from ..policies.view import View
from .switches import Drawn, Switches

__all__ = ["Accounting", "Tally"]

_P = len(LEVEL_PREDICTORS)


@dataclass(frozen=True, slots=True)
class Tally:
    """Counts of one frame: level predictors in order, then samples and state changes, and time."""

    level_counts: FloatArray
    shaded_samples: float
    state_changes: int
    gpu_ms: float
    fading: int


class Accounting:
    """Tables of one scene under one cost model, and the level history of its nodes."""

    def __init__(self, scene: Scene, costs: CostModel, crossfade_ns: int, camera: Camera) -> None:
        levels = scene.types.levels
        self._scene, self._levels, self._costs = scene, levels, costs
        self._any_continuous = bool(levels.continuous.any())
        self._finest = levels.start[:-1]
        self._linear_ms, self._geometry_ms = costs.level_ms(levels)
        self._few_rows = len(levels.error_m) <= 4096
        self.viewport_px = float(camera.viewport_px)
        self.switches = Switches(len(scene), crossfade_ns, self.viewport_px)

    def drawn(self, selection: Selection, view: View) -> Drawn:
        """Return what a valid selection draws."""
        whole = selection.ids is view.ids
        seen = view if whole else view.at(selection.ids)
        detail = selection.detail
        if self._any_continuous:
            row, fraction = self._levels.position(seen.type_index, detail)
            error_m = self._levels.interpolate(self._levels.error_m, row, fraction)
        else:
            row = self._finest[seen.type_index]
            row += detail.astype(np.int32)
            fraction = None
            error_m = self._levels.error_m[row]
        px_per_m = view.camera.focal_px * self._scene.scale[seen.ids]
        px_per_m /= seen.nearest_m
        return Drawn(seen.ids, detail, row, fraction, seen.area_px, error_m, px_per_m)

    def full_gpu_ms(self, view: View) -> float:
        """Return the noise-free GPU time of a view's nodes at full detail: the visible load."""
        return self._gpu_ms(self._finest[view.type_index], None, view.area_px)[2]

    def _gpu_ms(
        self, row: IntArray, fraction: FloatArray | None, area_px: FloatArray
    ) -> tuple[FloatArray, int, float]:
        costs = self._costs
        owners = self._levels.type_of_level
        if fraction is not None:
            counts = self._levels.interpolate(self._levels.counts, row, fraction).sum(axis=0)
            changes = len(np.unique(owners[row]))
        elif self._few_rows:
            times_drawn = np.bincount(row, minlength=len(owners))
            counts = times_drawn @ self._levels.counts
            used = np.add.reduceat(times_drawn, self._finest)
            changes = int(np.count_nonzero(used))
        else:
            counts = self._levels.counts[row].sum(axis=0)
            changes = len(np.unique(owners[row]))
        samples = float(area_px.sum())
        linear = costs.linear_ms
        ms = costs.base_ms + float(counts @ linear[:_P])
        ms += samples * float(linear[SHADED_SAMPLES])
        ms += self.viewport_px * float(linear[FRAMEBUFFER_PIXELS])
        ms += changes * float(linear[STATE_CHANGES])
        if costs.has_roofline:
            geometry = self._geometry_ms[row]
            if fraction is not None:
                geometry = self._levels.interpolate(self._geometry_ms, row, fraction)
            pixels = area_px * costs.roofline_ms[SHADED_SAMPLES]
            ms += float(np.maximum(geometry, pixels).sum())
        return counts, changes, ms

    def tally(self, time_ns: int, drawn: Drawn) -> Tally:
        """Return counts and noise-free GPU time, the old level of every cross-fade included."""
        row, fraction, area_px = drawn.row, drawn.fraction, drawn.area_px
        at, old_row = self.switches.fading(time_ns, drawn.ids)
        if len(at):
            row = np.concatenate((row, old_row))
            area_px = np.concatenate((area_px, area_px[at]))
            if fraction is not None:
                fraction = np.concatenate((fraction, np.zeros(len(at))))
        counts, changes, ms = self._gpu_ms(row, fraction, area_px)
        return Tally(counts, float(area_px.sum()), changes, ms, len(at))
