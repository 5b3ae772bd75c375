"""``gobbetti``: resolutions that minimise degradation within the predicted time."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.kept import Kept
from ..shared.knobs import AIM
from ..shared.ranges import Aim, BelowOne, Interval, PositiveInt, UpToOne, check_parameters
from ..shared.resolutions.held_resolutions import HeldResolutions
from ..shared.resolutions.resolution_problem import ResolutionProblem
from ..shared.resolutions.steady_costs import make_resolution_costs
from ..shared.times.v_time import VTime
from ..solvers.active_set import ActiveSet
from ..solvers.allocation import Allocation, solve
from ..view import View


def velocity_weight(speed_deg_s: FloatArray) -> FloatArray:
    """Return visual acuity at an apparent speed over acuity at rest, in (0, 1], (m,).

    Reddy's highest visible frequency, 60 cycles a degree up to 0.825 degrees a second, then
    ``57.69 - 27.78 log10(v)``, and 0.1 beyond 118.3.  Restored: the text at hand lost the formula;
    the constants meet at both joins to 0.02 %.
    """
    weight = np.maximum(speed_deg_s, 0.825)
    np.log10(weight, out=weight)
    weight *= -27.78 / 60.0
    weight += 57.69 / 60.0
    return np.minimum(np.maximum(weight, 0.1 / 60.0, out=weight), 1.0, out=weight)


def eccentricity_weight(angle_deg: FloatArray) -> FloatArray:
    """Return visual acuity at an angle from the focus over acuity at the focus, in (0, 1], (m,).

    Reddy's 1 up to 5.79 degrees, then ``7.49 / (0.3 e + 1)^2``.  Restored, as `velocity_weight`.
    """
    weight = 0.3 * angle_deg
    weight += 1.0
    np.divide(7.49, np.square(weight, out=weight), out=weight)
    return np.minimum(weight, 1.0, out=weight)


@dataclass
class Gobbetti:
    """Idea: minimise ``Σ s · w · r^-m`` over resolutions r while the predicted time keeps a budget.

    s is importance times Reddy's velocity and eccentricity factors (focus at the centre of the
    screen), w an image factor.  An object of the roofline cost ``max(T_tri · n · r, T_pix · A)`` is
    never coarser than ``T_pix · A / (T_tri · n)``, below which nothing is saved.  The active-set
    search begins with the bounds that hold at the last frame's price of time, and stops after
    `max_iterations` passes with what it has, which always keeps the budget; `newton` finds the same
    optimum without what the last frame knew.  If even the lowest resolutions do not fit, they are
    drawn.  Discrete types get the finest level not above their resolution, and what that saves is
    left unspent.

    With `hysteresis` h, degradation counts ``1 + h`` times below the last frame's resolution and
    ``1 - h`` times above it, which stays where neither is worth while.  With `ahead` the budget is
    for culling, optimising and drawing one after the other, as on the paper's single processor:
    drawing gets what that share leaves, or the newest completed frame's CPU time if that was more.

    Uses: the cost model, projected area, apparent speed, eccentricity, importance, its own last
    price of time; with `ahead` CPU times of completed frames.

    Parameters: `m`, `weight` (w: area, or area per triangle), `velocity` and `eccentricity`
    (whether the factors count), `hysteresis`, `ahead`, `engine`, `max_iterations` (passes of the
    active-set search), `adapt` (rate at which predictions follow measured times), `aim`.

    Cost per frame: O(n) a pass; two or three passes as a camera moves, some five at first and
    after a cut.

    Reference: Gobbetti and Bouvier, Time-critical multiresolution rendering of large complex
    models, CAD 2000; formulas restored, factors after Reddy 1997.  The paper bounds the search by
    a clock, which would make runs differ; a count of passes does not.
    """

    m: Annotated[int, Interval("[1, 2]")] = 1  # the exponent of mean projected triangle size
    weight: Literal["area-per-triangle", "area"] = "area-per-triangle"  # what the paper asks of w
    velocity: bool = True  # as in the paper
    eccentricity: bool = True  # as in the paper
    hysteresis: BelowOne = 0.0  # the paper's tests have none; its factor is not printed
    ahead: BelowOne | None = None  # None: culling and optimising overlap the drawing before
    engine: Literal["active-set", "newton"] = "active-set"  # the paper's
    max_iterations: PositiveInt = 48  # ours: ten times what frames take; the paper's limit is lost
    adapt: UpToOne = 0.0  # how fast predictions follow measured times; 0.2 with noise
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with this engine: a search that is cut off may be far from the optimum.

        With `adapt` the budget is kept by what frames took, not by the cost model.
        """
        if self.adapt:
            return Claims()
        exact = self.engine == "newton"
        monotone = exact and not self.hysteresis and self.ahead is None
        rests = exact and self.ahead is None
        return Claims(
            budget=self.aim <= 1.0, monotone=monotone, settles_frames=1 if rests else None
        )

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and turn the cost model into lines over resolution."""
        check_parameters(self, "gobbetti")
        self._costs = make_resolution_costs(scene, "gobbetti")
        self._budget_ms = self.aim * budget_ms
        self._v_time = VTime(self.adapt)
        self._search = ActiveSet(self.max_iterations)
        self._kept = Kept(self._importance)
        self._held = HeldResolutions(len(scene), self.hysteresis)

    def select(self, view: View) -> Selection:
        """Return the resolutions of least degradation that fit the budget."""
        costs = self._costs
        budget_ms = self._v_time.budget_ms(view, self._drawing_ms(view))
        problem = costs.problem(view, budget_ms)
        if problem.affords_all():
            # What anything is worth need not be known.
            selection = costs.in_full(view, Work(len(view), len(problem.cost), 1))
            self._held.keep(view.ids, np.ones(len(view)))
        else:
            result = self._solve(problem, view)
            work = Work(len(view), result.comparisons, result.iterations)
            resolution = self._held.resolution(problem, result.x)
            self._held.keep(view.ids, resolution)
            selection = costs.selection(view, resolution, budget_ms, work)
        if not self.adapt:
            return selection
        return replace(selection, predicted_ms=self._v_time.expect(selection.predicted_ms))

    def degradation(self, view: View) -> FloatArray:
        """Return the degradation of each candidate in full detail, ``s · w``, (m,)."""
        factor = view.area_px * self._kept.of(view)
        if self.velocity:
            factor *= velocity_weight(view.speed_deg_s)
        if self.eccentricity:
            factor *= eccentricity_weight(view.eccentricity_deg)
        return factor

    def _importance(self, view: View) -> FloatArray:
        """Return importance, and per triangle if that is what w is; the same in every frame."""
        importance = view.nodes.importance
        if self.weight == "area-per-triangle":
            return importance / self._costs.primitives(view)
        return importance

    def _drawing_ms(self, view: View) -> float:
        """Return what drawing may take."""
        if self.ahead is None:
            return self._budget_ms
        cpu_ms = view.completed.cpu_ms[-1:]
        before_ms = self.ahead * self._budget_ms
        if len(cpu_ms) and cpu_ms[0] > before_ms:  # not if a timer gave no number
            before_ms = float(cpu_ms[0])
        return max(self._budget_ms - before_ms, 0.0)

    def _solve(self, problem: ResolutionProblem, view: View) -> Allocation:
        weight = self.m * self.degradation(view)
        shares = self._held.shares(problem, view.ids, weight, self.m + 1.0)
        return solve(shares) if self.engine == "newton" else self._search.search(shares)
