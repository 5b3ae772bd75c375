"""``wimmer``: the closed form of the allocation, without bounds."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.kept import Kept
from ..shared.knobs import AIM
from ..shared.ranges import Aim, Interval, check_parameters
from ..shared.resolutions.resolution_problem import ResolutionProblem
from ..shared.resolutions.steady_costs import make_resolution_costs
from ..solvers.allocation import Shares, solve
from ..view import View


def clamped_shares(
    problem: ResolutionProblem, weight: FloatArray, power: float
) -> tuple[FloatArray, Work]:
    """Return the resolutions of the allocation without bounds, clamped, and the work, (m,).

    What clamping from above frees stays unspent.  Where clamping from below would exceed the
    budget, the allocation with bounds is returned instead, which lowers the others until it fits.
    """
    count = len(weight)
    cost, low = problem.cost[:count], problem.low[:count]
    # A second piece is full where the first has begun, which is all that the closed form knows.
    budget_ms = problem.budget_ms - float(problem.cost[count:] @ problem.high[count:])
    if 0.0 < budget_ms < math.inf:
        # The closed form of `allocation`: in proportion to `unit`, what it costs adding up.
        unit = Shares(weight, cost, budget_ms, power, low, low).unit()
        if not cost.all():
            unit[cost <= 0.0] = 0.0  # nothing is gained by less of what is free
        resolution = unit * (budget_ms / max(float(cost @ unit), 1e-300))
        np.minimum(
            np.maximum(resolution, low, out=resolution), problem.high[:count], out=resolution
        )
        if float(cost @ resolution) <= budget_ms:
            return resolution, Work(count, 2 * count, 1)
    bounded = solve(problem.shares(weight, power))
    work = Work(count, 2 * count + bounded.comparisons, 1 + bounded.iterations)
    return problem.resolution(bounded.x), work


@dataclass
class Wimmer:
    """Idea: share the predicted time by the one multiplier of the budget, in closed form.

    Maximises ``Σ importance · area · (1 - E / triangles^m)`` as if no object had a coarsest or a
    finest level: triangles are in proportion to ``(importance · area / cost of a
    triangle)^(1 / (m + 1))``.  The result is clamped to what there is, so that near objects leave
    budget unspent; if raising far ones to their coarsest level exceeds it, all others are lowered
    together until it fits.  If even the lowest resolutions do not fit, they are drawn.  Discrete
    types get the finest level not above their resolution.

    Uses: the cost model, projected area, importance.

    Parameters: `m` (exponent of the error), `aim`.

    Cost per frame: O(n), one pass; some more where the coarsest levels are in the way.

    Reference: Wimmer and Schmalstieg, Load balancing for smooth LODs, TR-186-2-98-31,
    1998, as Zach et al. 2002 describe it: a direct solution by Lagrange multipliers with the
    budget as the only constraint.
    """

    m: Annotated[int, Interval("[1, 2]")] = 1  # as in the benefit that the simulator scores
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(budget=self.aim <= 1.0, monotone=True, settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and turn the cost model into lines over resolution."""
        check_parameters(self, "wimmer")
        self._costs = make_resolution_costs(scene, "wimmer")
        self._budget_ms = self.aim * budget_ms
        self._kept = Kept(self._importance)

    def select(self, view: View) -> Selection:
        """Return the clamped shares of every candidate."""
        costs = self._costs
        problem = costs.problem(view, self._budget_ms)
        weight = view.area_px * self._kept.of(view)
        resolution, work = clamped_shares(problem, weight, self.m + 1.0)
        return costs.selection(view, resolution, self._budget_ms, work)

    def _importance(self, view: View) -> FloatArray:
        """Return importance per primitive to the power m; the same in every frame."""
        return view.scene.importance[view.ids] * self._costs.primitives(view) ** -float(self.m)
