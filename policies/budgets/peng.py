"""``peng``: a crowd's triangles shared by projected area."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.kept import Kept
from ..shared.knobs import AIM
from ..shared.ranges import Aim, Count, Interval, NotNegative, check_parameters
from ..shared.resolutions.resolution_problem import ResolutionProblem
from ..shared.resolutions.steady_costs import make_resolution_costs
from ..shared.resolutions.vertex_shares import VertexShares
from ..solvers.allocation import solve
from ..view import View
from .wimmer import clamped_shares


@dataclass
class Peng:
    """Idea: character i gets ``N · A_i^(1/α) / Σ A^(1/α)`` of N primitives; A is projected area.

    The paper sets N by hand, in vertices, which `vertices` does: each character's number of
    vertices is mapped to the triangles that it has with so many, and time is not asked.  Left at 0,
    N is what the predicted time pays for.  As printed a near character may get more than it has:
    `clipped` takes that away and leaves it unspent, `water-filled` shares it among the others.
    Where the coarsest levels alone would exceed the budget both lower the others until it fits; if
    nothing does, the lowest resolutions are drawn.
    A character whose area is below `threshold_px` gets nothing and is not drawn.  Discrete types
    get the finest level not above their resolution.

    Uses: the cost model, projected area.

    Parameters: `alpha` (weight of near characters falls with it), `vertices`, `mode`,
    `threshold_px`, `aim`.

    Cost per frame: O(n), one pass; some more where bounds are in the way.

    Reference: Peng, Park and Cao, A real-time system of crowd rendering, equation 1; the pixel
    threshold is that of the report they cite, which prints no value.
    """

    alpha: Annotated[float, Interval("[0.1, 10]")] = 3.0  # the paper's: as Funkhouser's benefit
    vertices: Count = 0  # the paper's N; 0 for as many primitives as the predicted time pays for
    mode: Literal["clipped", "water-filled"] = "clipped"  # as printed
    threshold_px: NotNegative = 0.0  # off
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        timed = self.aim <= 1.0 and not self.vertices
        return Claims(budget=timed, monotone=True, settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and turn the cost model into lines over resolution."""
        check_parameters(self, "peng")
        self._costs = make_resolution_costs(scene, "peng")
        self._budget_ms = self.aim * budget_ms
        self._kept = Kept(self._spread)
        self._vertex_shares = VertexShares(scene.types.levels, self.alpha)

    def select(self, view: View) -> Selection:
        """Return the shares of every candidate that is large enough."""
        costs, candidates = self._costs, len(view)
        seen = view
        if self.threshold_px > 0.0 and not (large := view.area_px >= self.threshold_px).all():
            seen = view.at(view.ids[large])
        if self.vertices:
            filled = self.mode == "water-filled"
            resolution, work = self._vertex_shares.of(seen, float(self.vertices), filled=filled)
            work = Work(candidates, work.comparisons + candidates, work.iterations)
            detail = costs.detail(seen, resolution)
            return Selection(seen.ids, detail, work, predicted_ms=costs.predict_ms(seen, detail))
        problem = costs.problem(seen, self._budget_ms)
        resolution, work = self._share(problem, seen)
        work = Work(candidates, work.comparisons + candidates, work.iterations)
        return costs.selection(seen, resolution, self._budget_ms, work)

    def _share(self, problem: ResolutionProblem, view: View) -> tuple[FloatArray, Work]:
        # The weight at which (weight / cost)^(1/α) is A^(1/α) over full primitives.
        weight = problem.cost[: len(view)] * view.area_px
        weight *= self._kept.of(view)
        if self.mode == "clipped":
            return clamped_shares(problem, weight, self.alpha)
        result = solve(problem.shares(weight, self.alpha))
        work = Work(len(view), result.comparisons, result.iterations)
        return problem.resolution(result.x), work

    def _spread(self, view: View) -> FloatArray:
        """Return full primitives to the power -α; the same in every frame."""
        return self._costs.primitives(view) ** -self.alpha
