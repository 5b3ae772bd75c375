"""``oracle``: the best selection there is for each frame, knowing what it will cost."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ...models.machine.frame_cost import FrameCost
from ...models.scene.scene import Scene
from ..protocol import Capabilities, Claims, Truth
from ..selection import Selection
from ..shared.levels.choices import LevelChoices, Offer, importance
from ..shared.levels.level_hulls import make_level_hulls
from ..shared.ranges import Count, check_parameters
from ..solvers.knapsack import affordable, hull_increments, take_increments
from ..view import View


@dataclass
class Oracle:
    """Idea: the optimum of the multiple-choice knapsack for the frame about to be drawn.

    It is told the true cost model and the frame's noise, which no real policy can know, and uses
    the score's own benefit (size · accuracy · importance).  With up to `exact_up_to` objects in
    view HiGHS solves the problem exactly; beyond, increments on the upper hull by falling slope,
    going on behind misfits.  The linear relaxation bounds how far that is from the optimum, and is
    logged in every frame of an oracle (`benefit_bound`, metric `optimality`).  With continuous
    types in view the convex optimum is found by the price of time at which every object's best
    response uses the budget up.

    Uses: the truth, through the oracle's channel; projected area.

    Parameters: `exact_up_to`.

    Knob: none, as it knows what the budget buys and no other share of it would be a bound.

    Cost per frame: not charged; an oracle is a bound, not a competitor.

    Reference: Sinha and Zoltners, Operations Research 27, 1979; HiGHS through scipy's ``milp``.
    """

    exact_up_to: Count = 40  # ours: HiGHS takes about 10 ms there, and seconds at 3,000 objects

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, future=True)
    claims: ClassVar[Claims] = Claims(budget=True, settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget the last replay."""
        check_parameters(self, "oracle")
        self._scene, self._budget_ms = scene, budget_ms
        self._truth = self._choices = self._hulls = None
        self._all_discrete = not scene.types.levels.continuous.any()

    def foresee(self, truth: Truth) -> None:
        """Note the truth about the next frame."""
        if self._truth is None or truth.costs is not self._truth.costs:
            costs = FrameCost(truth.costs, self._scene.types.levels)
            self._choices = LevelChoices(self._scene, costs, 1.0)
            width = int(self._scene.types.levels.level_count.max())
            self._hulls = make_level_hulls(self._scene, costs, 1.0, np.ones((1, width)))
        self._truth = truth

    def select(self, view: View) -> Selection:
        """Return the optimal selection within the budget."""
        if self._truth is None or self._choices is None:
            raise InputError("oracle: expected to be told the truth first; call foresee")
        hulls = self._hulls
        if hulls is not None and len(view) > self.exact_up_to and self._all_discrete:
            size = view.area_px * view.nodes.importance
            budget_ms = self._budget_ms / self._truth.gpu_factor
            return Selection(
                view.ids, hulls.choose(view, size, budget_ms, skip_misfits=True).detail
            )
        offer = self._choices.offer(view, importance)
        if not len(offer.objects):
            return Selection(view.ids, np.zeros(0), predicted_ms=offer.fixed_ms)
        budget_ms = self._budget_ms / self._truth.gpu_factor - offer.fixed_ms
        soft = view.scene.continuous[view.ids]
        if soft.any():
            best, _ = offer.smooth(soft).within(budget_ms)
            return Selection(view.ids, self._choices.between(view, best.column, best.share))
        increments = hull_increments(affordable(offer.cost_ms, budget_ms), offer.benefit)
        column = take_increments(increments, budget_ms, skip_misfits=True).column
        if len(column) <= self.exact_up_to:
            column = exact_choice(offer, budget_ms, column)
        return Selection(view.ids, column.astype(np.float64))


def exact_choice(offer: Offer, budget_ms: float, known: IntArray) -> IntArray:
    """Return the optimal column of each row, by HiGHS; `known` if nothing fits the budget."""
    import scipy.sparse as sp
    from scipy.optimize import Bounds, LinearConstraint, milp

    real = np.isfinite(offer.cost_ms)
    row, column = np.nonzero(real)
    one_each = sp.csr_array((np.ones(len(row)), (row, np.arange(len(row)))))
    solution = milp(
        -offer.benefit[real],
        constraints=[
            LinearConstraint(one_each, 1, 1),
            LinearConstraint(offer.cost_ms[real][None, :], -np.inf, budget_ms),
        ],
        integrality=np.ones(len(row), dtype=np.int32),
        bounds=Bounds(0, 1),
        options={"mip_rel_gap": 0.0},
    )
    if solution.x is None:
        return known
    best = known.copy()
    chosen: FloatArray = np.asarray(solution.x, dtype=np.float64)
    best[row[chosen > 0.5]] = column[chosen > 0.5]
    return best
