"""The most benefit that any selection of a frame's cost can have."""

import math

import numpy as np

from ...models.machine.frame_cost import FrameCost
from ...models.scene.scene import Scene
from ...policies.shared.levels.choices import LevelChoices, importance
from ...policies.shared.levels.level_hulls import make_level_hulls
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
        levels = scene.types.levels
        plain = np.ones((1, int(levels.level_count.max())))
        # Where types alone say by what levels differ, hulls need not be built in every frame.
        discrete = self._every and not levels.continuous.any()
        self._hulls = make_level_hulls(scene, costs, 1.0, plain) if discrete else None

    def of(self, view: View, gpu_ms: float) -> float:
        """Return the bound for a frame of this noise-free GPU time, NaN if it is not computed."""
        if self._choices is None or view.frame % self._every:
            return math.nan
        if not len(view):
            return 0.0
        # What the frame cost includes rounding: a bound must not fall below the frame itself.
        budget_ms = gpu_ms * (1.0 + 1e-12)
        if self._hulls is not None:
            return self._hulls.bound(view, view.area_px * view.nodes.importance, budget_ms)
        offer = self._choices.offer(view, importance)
        budget_ms -= offer.fixed_ms
        soft = view.scene.continuous[view.ids]
        if soft.any():
            # The hull over knots would be below the optimum: resolutions between them do better.
            return offer.smooth(soft).within(budget_ms)[1]
        return relaxed_bound(hull_increments(offer.cost_ms, offer.benefit), budget_ms)
