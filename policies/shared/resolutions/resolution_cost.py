"""What a frame costs as a function of the resolution of each node, for policies that allocate.

Between two knots of a level table every count is linear in the resolution r, so the cost model
makes of a type ``linear(r) + max(geometry(r), pixel side)``.  Where the costs of all knots lie on
a line, as with one draw call and so much a triangle, fixed and proportional parts are exact; where
they do not (vertices that fall slower than triangles), the lowest line of the chord's slope that is
nowhere below them stands for them, so that what is predicted from it is never too little.  A line
above them stands for the terms of the view too, such as a tangent for rasterized triangles.
"""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ....models.scene.benefit import level_primitives
from ....models.scene.levels import LevelTable
from ....models.scene.scene import Scene
from ...selection import Selection, Work
from ...view import View
from ..levels.choices import require_costs
from ..levels.discretise import nearest_level
from .resolution_problem import ResolutionProblem

_LEAST_RESOLUTION = 1e-9
"""Stands for 0, which is no resolution, where the coarsest level of a type is empty."""

KEPT_BACK = 1e-9
"""Share of the budget that is left to rounding, so that a prediction never exceeds it."""


class ResolutionCosts:
    """The cost model of a scene as lines over resolution, one of each kind a type."""

    def __init__(self, scene: Scene, policy: str) -> None:
        """Raise InputError if the scene has no cost model; `policy` is named in the message."""
        costs = self._costs = require_costs(scene, policy)
        levels = self._levels = scene.types.levels
        self._linear_line = _line_above(levels, costs.level_ms)
        self._geometry_line = _line_above(levels, costs.geometry_ms)
        self._exact = self._linear_line.exact and self._geometry_line.exact
        self._exact &= costs.linear_in_detail
        self._primitives = np.maximum(level_primitives(levels)[levels.start[:-1]], 1.0)
        self._low = np.maximum(levels.min_resolution, _LEAST_RESOLUTION)

    def fixed_ms(self, view: View) -> float:
        """Return what a frame costs before its first object; every candidate's type is drawn."""
        types = self._costs.types_drawn(view.type_index, view)
        return self._costs.fixed_ms(view.viewport_px, types, len(view))

    def problem(self, view: View, budget_ms: float) -> ResolutionProblem:
        """Return the allocation problem of a frame."""
        fixed, slow, cost, low = self.stretches(view)
        bottom = self.lowest(view)
        # Two pieces make r = x₁ + x₂ - kink, at fixed + cost · x₁ + slow · (x₂ - kink).  The
        # constant slow · kink goes to the budget below, so that Σ cost · x is left to be paid.
        second = np.flatnonzero((cost > slow) & (low > bottom) & (slow > 0.0))
        left_ms = budget_ms * (1.0 - KEPT_BACK) - self.fixed_ms(view)
        left_ms -= float(fixed.sum()) - float(slow[second] @ low[second])
        # Lines above the true cost may refuse full detail that fits, so that is asked of the model.
        if not self._exact and self.predict_ms(view, self.finest(view)) <= budget_ms:
            left_ms = np.inf
        high = np.ones(len(cost))
        if len(second):
            high = np.concatenate((high, low[second]))
            cost = np.concatenate((cost, slow[second]))
            low = np.concatenate((low, bottom[second]))
        low_ms, high_ms = float(cost @ low), float(cost @ high)
        return ResolutionProblem(left_ms, cost, low, high, second, low_ms, high_ms)

    def stretches(self, view: View) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return fixed cost, slope before the kink, slope after it, and where the latter begins.

        Before the kink the pixel side is the larger and only what is linear rises.  Where nothing
        rises less detail saves nothing, and the stretch that matters begins at its end: the paper's
        pixel bound.  From there on a candidate costs fixed + slope · r, all (m,).
        """
        kind = view.type_index
        pixel_ms = self._costs.pixel_ms * view.area_px
        draws = self._costs.draws_of(view)
        slow, fast = self._linear_line.slope[kind] * draws, self._geometry_line.slope[kind] * draws
        under = self._geometry_line.start[kind] * draws
        # Resolution at which geometry, under + fast · r, overtakes the pixels.
        kink = np.divide(pixel_ms - under, fast, out=np.full(len(kind), np.inf), where=fast > 0.0)
        bent = kink < 1.0
        # Before the kink the larger side is a constant: the pixels, or geometry that does not rise.
        hidden = np.where(bent, under, np.maximum(under, pixel_ms))
        bottom = self.lowest(view)
        start, rise = self._costs.view_line_above(kind, view, bottom)
        hidden, slow = hidden + start, slow + rise
        cost = slow + np.where(bent, fast, 0.0)
        # Gobbetti and Bouvier's r_min = T_pix · A / (T_tri · n), never below the coarsest level.
        low = np.where(bent, np.maximum(kink, bottom), np.where(cost > 0.0, bottom, 1.0))
        return self._linear_line.start[kind] * draws + hidden, slow, cost, low

    def predict_ms(self, view: View, detail: FloatArray) -> float:
        """Return the frame's GPU time with the candidates at these details, exactly."""
        row, fraction = self._levels.position(view.type_index, detail)
        objects_ms = self._costs.objects_ms(row, view, fraction=fraction)
        return self.fixed_ms(view) + float(objects_ms.sum())

    def least_ms(self, view: View) -> float:
        """Return the frame's GPU time with every candidate at its coarsest."""
        return self.predict_ms(view, self.detail(view, self.lowest(view)))

    def detail(self, view: View, resolution: FloatArray) -> FloatArray:
        """Return resolutions of continuous types, and the nearest level not above of others."""
        soft = self._levels.continuous[view.type_index]
        if soft.all():
            return resolution
        level = nearest_level(self._levels, view.type_index, resolution)
        return np.where(soft, resolution, level)

    def resolution(self, view: View, detail: FloatArray) -> FloatArray:
        """Return the resolution that each candidate has at a detail, (m,)."""
        row, _ = self._levels.position(view.type_index, detail)
        soft = self._levels.continuous[view.type_index]
        return np.where(soft, detail, self._levels.resolution[row])

    def primitives(self, view: View) -> FloatArray:
        """Return the primitives of every candidate in full detail, at least 1, (m,)."""
        return self._primitives.take(view.nodes.type_at)

    def finest(self, view: View) -> FloatArray:
        """Return every candidate in full detail, (m,)."""
        return self._levels.continuous[view.type_index].astype(np.float64)

    def lowest(self, view: View) -> FloatArray:
        """Return the resolution of every candidate at its coarsest, (m,)."""
        return self._low[view.type_index]

    def in_full(self, view: View, work: Work) -> Selection:
        """Return the selection of full detail."""
        finest = self.finest(view)
        return Selection(view.ids, finest, work, predicted_ms=self.predict_ms(view, finest))

    def selection(
        self, view: View, resolution: FloatArray, budget_ms: float, work: Work
    ) -> Selection:
        """Return the selection of these resolutions and its predicted time.

        Where lines stand above a type's cost, resolutions found by them may miss that the coarsest
        fits while they do not; then the coarsest is drawn.
        """
        detail = self.detail(view, resolution)
        predicted_ms = self.predict_ms(view, detail)
        if predicted_ms > budget_ms and not self._exact:
            coarsest = self.detail(view, self.lowest(view))
            least_ms = self.predict_ms(view, coarsest)
            if least_ms <= budget_ms:
                detail, predicted_ms = coarsest, least_ms
        return Selection(view.ids, detail, work, predicted_ms=predicted_ms)


@dataclass(frozen=True, slots=True)
class _Line:
    """``start + slope · r`` of each type, and whether the costs of all knots lie on it."""

    start: FloatArray
    slope: FloatArray
    exact: bool


def _line_above(levels: LevelTable, column: FloatArray) -> _Line:
    """Return for each type the lowest line of its chord's slope (not falling) above all knots."""
    first, last = levels.start[:-1], levels.start[1:] - 1
    rise = np.maximum(column[first] - column[last], 0.0)
    width = 1.0 - levels.resolution[last]
    slope = np.divide(rise, width, out=np.zeros(len(first)), where=width > 0.0)
    # The intercept that each knot asks for; with the largest of them no knot lies above the line.
    gap = column - slope[levels.type_of_level] * levels.resolution
    start = np.maximum.reduceat(gap, first)
    exact = np.allclose(gap, start[levels.type_of_level], rtol=0.0, atol=1e-12 * column.max())
    return _Line(start, slope, exact)
