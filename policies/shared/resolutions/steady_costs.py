"""Lines over resolution, the same in every frame where types alone say what levels cost."""

from typing import NamedTuple

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.scene.scene import Scene
from ...selection import Selection, Work
from ...solvers.column_counts import count_true
from ...view import View
from ..kept import Kept
from ..levels.choices import require_costs
from .resolution_cost import KEPT_BACK, ResolutionCosts
from .resolution_problem import ResolutionProblem

_NONE = np.zeros(0, dtype=np.intp)


class _Same(NamedTuple):
    """What is the same of m candidates in every frame.

    Attributes
    ----------
    kind, first : (m,) int
        Types, and rows of the finest levels.
    types : int
        Distinct types.
    start_ms, full_ms : float
        Sums of where lines start, and of what full detail costs, whatever the view.
    low_ms, high_ms : float
        Sums of slope times low and times high.
    least_ms : float
        Sum of what the coarsest levels cost, whatever the view.
    slope, low, high : (m,) float64
        Milliseconds per unit of resolution, and its bounds.
    key : (L - 1, m) float64
        Coarseness of levels as `nearest_level` orders them, finest first; infinite for the
        coarsest, which is what is left, and where there is none.
    """

    kind: IntArray
    first: IntArray
    types: int
    start_ms: float
    full_ms: float
    low_ms: float
    high_ms: float
    least_ms: float
    slope: FloatArray
    low: FloatArray
    high: FloatArray
    key: FloatArray


class SteadyCosts(ResolutionCosts):
    """`ResolutionCosts` without a roofline and without terms of the view that read levels."""

    def __init__(self, scene: Scene, policy: str) -> None:
        """Raise InputError if the scene has no cost model; `policy` is named in the message."""
        super().__init__(scene, policy)
        levels = scene.types.levels
        columns = np.arange(int(levels.level_count.max()))[:-1]
        row = levels.rows_by_type()
        coarseness = 1.0 - levels.resolution[row[:, :-1]]
        key = np.where(columns < levels.level_count[:, None] - 1, coarseness, np.inf)
        self._key = np.ascontiguousarray(key.T)
        line = self._linear_line
        # Where nothing rises with the resolution less detail saves nothing.
        self._least = np.where(line.slope > 0.0, self._low, 1.0)
        full_ms = self._costs.level_ms[levels.start[:-1]]
        least_ms = self._costs.level_ms[levels.start[1:] - 1]
        self._sums = np.array((line.start, full_ms, line.slope * self._least, line.slope, least_ms))
        self._any_soft, self._all_soft = levels.continuous.any(), levels.continuous.all()
        self._kept = Kept(self._gather)
        self._seen: View | None = None
        self._known_ms = 0.0

    def _gather(self, view: View) -> _Same:
        nodes = view.nodes
        kind = nodes.type_at
        # Few types: what many objects sum to is told by how many there are of each.
        count = np.bincount(kind, minlength=len(self._least))
        start_ms, full_ms, low_ms, high_ms, least_ms = (self._sums @ count).tolist()
        return _Same(
            kind,
            nodes.finest_row,
            int(np.count_nonzero(count)),
            start_ms,
            full_ms,
            low_ms,
            high_ms,
            least_ms,
            self._linear_line.slope.take(kind),
            self._least.take(kind),
            np.ones(len(kind)),
            self._key.take(kind, axis=1),
        )

    def fixed_ms(self, view: View) -> float:
        """Return what a frame costs before its first object, as `ResolutionCosts`."""
        return self._costs.fixed_ms(view.viewport_px, self._kept.of(view).types, len(view))

    def problem(self, view: View, budget_ms: float) -> ResolutionProblem:
        """Return the allocation problem of a frame."""
        same = self._kept.of(view)
        rest_ms = self._rest_ms(view, same)
        left_ms = budget_ms * (1.0 - KEPT_BACK) - rest_ms - same.start_ms
        if not self._exact and same.full_ms + rest_ms <= budget_ms:
            left_ms = np.inf
        return ResolutionProblem(
            left_ms, same.slope, same.low, same.high, _NONE, same.low_ms, same.high_ms
        )

    def in_full(self, view: View, work: Work) -> Selection:
        """Return the selection of full detail."""
        same = self._kept.of(view)
        finest = self.finest(view) if self._any_soft else np.zeros(len(view))
        predicted_ms = self._rest_ms(view, same) + same.full_ms
        return Selection(view.ids, finest, work, predicted_ms=predicted_ms)

    def predict_ms(self, view: View, detail: FloatArray) -> float:
        """Return the frame's GPU time with the candidates at these details, exactly."""
        same, levels = self._kept.of(view), self._levels
        if self._any_soft:
            row, fraction = levels.position(view.type_index, detail)
            objects_ms = levels.interpolate(self._costs.level_ms, row, fraction)
        else:
            objects_ms = self._costs.level_ms.take(same.first + detail.astype(np.intp))
        return self._rest_ms(view, same) + float(objects_ms.sum())

    def least_ms(self, view: View) -> float:
        """Return the frame's GPU time with every candidate at its coarsest."""
        same = self._kept.of(view)
        return self._rest_ms(view, same) + same.least_ms

    def detail(self, view: View, resolution: FloatArray) -> FloatArray:
        """Return resolutions of continuous types, and the nearest level not above of others."""
        if self._all_soft:
            return resolution
        same = self._kept.of(view)
        level = count_true(np.less(same.key, 1.0 - resolution)).astype(np.float64)
        if not self._any_soft:
            return level
        return np.where(self._levels.continuous.take(same.kind), resolution, level)

    def _rest_ms(self, view: View, same: _Same) -> float:
        """Return what does not depend on levels; it is asked for twice a frame."""
        if view is not self._seen:
            fixed_ms = self._costs.fixed_ms(view.viewport_px, same.types, len(view))
            self._seen, self._known_ms = view, fixed_ms + self._costs.anyway_ms(view)
        return self._known_ms


def make_resolution_costs(scene: Scene, policy: str) -> ResolutionCosts:
    """Return a scene's costs over resolution; raise InputError if it has no cost model."""
    costs = require_costs(scene, policy)
    steady = costs.linear_in_detail and not costs.model.has_roofline
    return SteadyCosts(scene, policy) if steady else ResolutionCosts(scene, policy)
