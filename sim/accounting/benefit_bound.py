"""The most benefit that any selection of a frame's cost can have."""

import math

from ...models.machine.frame_cost import FrameCost
from ...models.scene.scene import Scene
from ...policies.shared.choices import LevelChoices, importance
from ...policies.solvers.knapsack import hull_increments, relaxed_bound
from ...policies.view import View


class BenefitBound:
    """Relaxed optimum at the cost that a frame had, for the metric `optimality`.

    Benefit and cost are those that `FlatQuality` and `Accounting` count, so that the relaxation is
    a true bound (under a roofline the cost of a continuous type is taken as linear between its
    knots, which is never less than it is).  Hierarchies have no bound: NaN.
    """

    def __init__(self, scene: Scene, costs: FrameCost, every: int) -> None:
        # Alternatives of a hierarchy are fronts of uniform depth, whose optimum bounds no others.
        self._every = every if scene.flat else 0
        self._choices = LevelChoices(scene, costs, 1.0) if self._every else None

    def of(self, view: View, gpu_ms: float) -> float:
        """Return the bound for a frame of this noise-free GPU time, NaN if it is not computed."""
        if self._choices is None or view.frame % self._every:
            return math.nan
        offer = self._choices.offer(view, importance)
        if not len(offer.objects):
            return 0.0
        # What the frame cost includes rounding: a bound must not fall below the frame itself.
        budget_ms = gpu_ms * (1.0 + 1e-12) - offer.fixed_ms
        soft = view.scene.continuous[view.ids]
        if soft.any():
            # The hull over knots would be below the optimum: resolutions between them do better.
            return offer.smooth(soft).within(budget_ms)[1]
        return relaxed_bound(hull_increments(offer.cost_ms, offer.benefit), budget_ms)
