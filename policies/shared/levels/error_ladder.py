"""Levels by their error on the screen."""

from typing import NamedTuple

import numpy as np

from ....base.arrays import FloatArray
from ....models.scene.scene import Scene
from ...selection import Selection, Work
from ...solvers.column_counts import count_true
from ...view import View
from ..kept import Kept
from .discretise import detail_of_level, level_of_detail


class _Same(NamedTuple):
    """What is the same of some candidates in every frame: errors of their levels, and scales."""

    error_m: FloatArray  # (L, m)
    scale: FloatArray


class ErrorLadder:
    """Errors of all types' levels, padded to one width."""

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        width = np.arange(int(levels.level_count.max()))
        row = levels.rows_by_type()
        real = width < levels.level_count[:, None]
        self._error_m = np.where(real, levels.error_m[row], np.inf)
        self._levels, self._scale = levels, scene.scale
        self._kept = Kept(self._gather)

    def select(self, view: View, threshold_px: float, hysteresis: float) -> Selection:
        """Return the coarsest level (or knot) of every candidate with at most this error in px.

        The error is that at the nearest point of the bounding sphere; where even the finest level
        is worse, that one is drawn.  A level coarser than the last one needs an error smaller than
        the threshold by the hysteresis share.
        """
        same = self._kept.of(view)
        allowed_m = view.nearest_m / (view.camera.focal_px * same.scale)
        allowed_m *= threshold_px
        level = _coarsest(same.error_m, allowed_m)
        if hysteresis:
            before = level_of_detail(self._levels, view.type_index, view.previous_detail)
            late = _coarsest(same.error_m, allowed_m * (1.0 - hysteresis))
            # Coarser only as far as the margin allows too; a comparison with NaN is false.
            hold = level > before
            level[hold] = np.maximum(late, before)[hold]
        detail = detail_of_level(self._levels, view.type_index, level)
        return Selection(view.ids, detail, Work(objects_visited=len(view.ids)))

    def _gather(self, view: View) -> _Same:
        error_m = np.ascontiguousarray(self._error_m.take(view.type_index, axis=0).T)
        return _Same(error_m, self._scale.take(view.ids))


def _coarsest(error_m: FloatArray, allowed_m: FloatArray) -> FloatArray:
    level = count_true(np.less_equal(error_m, allowed_m)) - 1.0
    return np.maximum(level, 0.0, out=level)
