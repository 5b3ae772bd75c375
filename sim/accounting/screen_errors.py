"""Errors on the screen of what frames draw."""

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from .switches import Drawn

_NEAR = 0.97  # share of the last percentile above which the next frame's is looked for


class ScreenErrors:
    """Errors on the screen of what frames draw, one frame after another."""

    def __init__(self, visible_px: float) -> None:
        self._visible_px = visible_px
        self._above_px = 0.0  # where the next frame's percentile should be
        # Of the last frame: pixels of each node's error at a distance of 1 m, and what of.
        self._scaled = np.zeros(0)
        self._of: tuple[FloatArray, object] = self._scaled, None

    def of(self, drawn: Drawn) -> tuple[float, float, float]:
        """Return the 95th percentile (lower rank) and maximum of nodes' errors in px.

        The third is the mean over nodes, by their area, of what of the error is visible; of the
        worst picture where several cameras look.
        """
        count = len(drawn.ids)
        if not count:
            return 0.0, 0.0, 0.0
        sse_px = self._errors_px(drawn)
        # Only what may be above the percentile, or visible, is looked at further: errors change
        # little from frame to frame, and a partition of all of them takes most of the time.
        above_px = min(self._above_px, self._visible_px)
        at = (sse_px > above_px).nonzero()[0]
        top_px = sse_px.take(at)
        visible_px = self._visible_by_area(top_px, at, drawn)
        # As many as are left out stand below it.
        rank = int(0.95 * (count - 1)) - (count - len(top_px))
        if rank < 0:
            if not above_px:  # what is left out has no error
                return 0.0, float(top_px.max(initial=0.0)), visible_px
            rank, top_px = rank + count - len(top_px), sse_px
        top_px.partition((rank, len(top_px) - 1))
        percentile_px = float(top_px[rank])
        self._above_px = _NEAR * percentile_px
        return percentile_px, float(top_px[-1]), visible_px

    def _errors_px(self, drawn: Drawn) -> FloatArray:
        """Return each node's error in px at its nearest point, (m,)."""
        seen, error_m = drawn.seen, drawn.error_m
        lens, near_m = seen.lens, seen.camera.near_m
        if self._of[0] is not error_m or self._of[1] is not seen.nodes:
            self._of, self._scaled = (error_m, seen.nodes), error_m * lens.scale_px
        nearest_m = seen.distance_m - lens.radius_m
        np.maximum(nearest_m, near_m, out=nearest_m)
        return np.divide(self._scaled, nearest_m, out=nearest_m)

    def _visible_by_area(self, top_px: FloatArray, at: NDArray[np.intp], drawn: Drawn) -> float:
        beyond_px = top_px - self._visible_px
        if not len(beyond_px) or beyond_px.max() <= 0.0:
            return 0.0
        np.maximum(beyond_px, 0.0, out=beyond_px)
        worst_px = 0.0
        for area_px in drawn.seen.areas_px:
            whole_px = float(np.add.reduce(area_px))
            # A product of vectors adds in an order of its own.
            by_area = float(np.add.reduce(beyond_px * area_px.take(at)))
            worst_px = max(worst_px, by_area / whole_px if whole_px else 0.0)
        return worst_px
