"""The most benefit that any selection of a frame's cost can have."""

import math

from ..models.arrays import FloatArray
from ..models.cost import CostModel
from ..models.knapsack import hull_increments, relaxed_bound
from ..models.scene import Scene
from ..policies.choices import make_choices
from ..policies.view import View

__all__ = ["BenefitBound"]


class BenefitBound:
    """Relaxed optimum at the cost that a frame had, for the metric `optimality`.

    Benefit and cost are those that `FlatQuality` and `Accounting` count, continuous types lying
    linearly between their knots, so that the relaxation is a true bound (and for continuous types
    of a linear cost model its optimum).  Hierarchies have no bound: NaN.
    """

    def __init__(self, scene: Scene, costs: CostModel, every: int) -> None:
        self._every = every if scene.flat else 0
        self._choices = make_choices(scene, costs, 1.0) if self._every else None

    def of(self, view: View, gpu_ms: float) -> float:
        """Return the bound for a frame of this noise-free GPU time, NaN if it is not computed."""
        if self._choices is None or view.frame % self._every:
            return math.nan
        offer = self._choices.offer(view, _importance)
        if not len(offer.objects):
            return 0.0
        return relaxed_bound(hull_increments(offer.cost_ms, offer.benefit), gpu_ms - offer.fixed_ms)


def _importance(view: View) -> FloatArray:
    return view.scene.importance[view.ids]
