"""``oracle``: the best selection there is for each frame, knowing what it will cost."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..errors import InputError
from ..models.arrays import FloatArray, IntArray
from ..models.knapsack import Choice, Increments, hull_increments, take_increments
from ..models.scene import Scene
from .choices import Choices, Offer, make_choices
from .protocol import Capabilities, Truth
from .selection import Selection, Work
from .view import View

__all__ = ["Oracle", "exact_choice"]


@dataclass(slots=True)
class Oracle:
    """Idea: the optimum of the multiple-choice knapsack for the frame about to be drawn.

    It is told the true cost model and the frame's noise, which no real policy can know, and uses
    the score's own benefit (size · accuracy · importance).  With up to `exact_up_to` objects in
    view HiGHS solves the problem exactly; beyond, increments on the upper hull by falling slope,
    going on behind misfits.  The linear relaxation bounds how far that is from the optimum, and is
    logged in every frame of an oracle (`benefit_bound`, metric `optimality`).  A continuous type is
    raised between its knots by what is left of the budget, which makes its relaxation exact.

    Uses: the truth, through the oracle's channel; projected area.

    Parameters: `exact_up_to`.

    Cost per frame: not charged; an oracle is a bound, not a competitor.

    Reference: Sinha and Zoltners, Operations Research 27, 1979; HiGHS through scipy's ``milp``.
    """

    exact_up_to: int = 40  # ours: HiGHS takes about 10 ms there, and seconds at 3,000 objects
    _budget_ms: float = field(init=False, default=0.0)
    _scene: Scene = field(init=False)
    _truth: Truth | None = field(init=False, default=None)
    _choices: Choices | None = field(init=False, default=None)

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, future=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget the last replay."""
        if self.exact_up_to < 0:
            raise InputError(f"oracle: expected exact_up_to >= 0, got {self.exact_up_to}")
        self._scene, self._budget_ms = scene, budget_ms
        self._truth = self._choices = None

    def foresee(self, truth: Truth) -> None:
        """Note the truth about the next frame."""
        if self._truth is None or truth.costs is not self._truth.costs:
            self._choices = make_choices(self._scene, truth.costs, 1.0)
        self._truth = truth

    def select(self, view: View) -> Selection:
        """Return the optimal selection within the budget."""
        if self._truth is None or self._choices is None:
            raise InputError("oracle: expected to be told the truth first; call foresee")
        offer = self._choices.offer(view, _importance)
        if not len(offer.objects):
            return Selection(view.ids, np.zeros(0), predicted_ms=offer.fixed_ms)
        budget_ms = self._budget_ms / self._truth.gpu_factor - offer.fixed_ms
        increments = hull_increments(offer.cost_ms, offer.benefit)
        choice = take_increments(increments, budget_ms, skip_misfits=True)
        column, rows = choice.column, np.arange(len(choice.column))
        soft = view.scene.continuous[view.ids]
        if len(rows) <= self.exact_up_to and not soft.any():
            column = exact_choice(offer, budget_ms, column)
        everything = np.ones(len(rows), dtype=np.bool_)
        ids, detail = self._choices.drawn(view, column, everything)
        left_ms = budget_ms - choice.cost
        if soft.any() and left_ms > 0.0:
            raised = _next_knot(increments, choice, np.flatnonzero(soft))
            if raised is not None:
                row, to, cost_ms = raised
                share = min(1.0, left_ms / cost_ms)
                finer = self._choices.drawn(view, np.where(rows == row, to, column), everything)[1]
                detail[row] += share * (finer[row] - detail[row])
        return Selection(ids, detail, Work())


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
        integrality=[1] * len(row),
        bounds=Bounds(0, 1),
        options={"mip_rel_gap": 0.0},
    )
    if solution.x is None:
        return known
    best = known.copy()
    chosen: FloatArray = np.asarray(solution.x, dtype=np.float64)
    best[row[chosen > 0.5]] = column[chosen > 0.5]
    return best


def _next_knot(
    increments: Increments, choice: Choice, soft: IntArray
) -> tuple[int, int, float] | None:
    """Return row, column and cost of the steepest knot that a continuous row has left to take."""
    # Only to a neighbouring knot: in between, cost and benefit are linear by definition.
    near = np.abs(increments.column - choice.column[increments.owner]) == 1
    open_ = ~choice.taken & near & np.isin(increments.owner, soft)
    if not open_.any():
        return None
    first = int(open_.argmax())
    return (
        int(increments.owner[first]),
        int(increments.column[first]),
        float(increments.cost[first]),
    )


def _importance(view: View) -> FloatArray:
    return view.scene.importance[view.ids]
