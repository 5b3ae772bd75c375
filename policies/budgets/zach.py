"""``zach``: discrete increments and smooth resolutions within one predicted budget."""

from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.knobs import AIM
from ..shared.levels.choices import require_costs
from ..shared.mixed.zach_fractions import FractionPlan, Fractions
from ..shared.mixed.zach_groups import Groups, Plan
from ..shared.mixed.zach_levels import FlatLevels, make_flat_levels
from ..shared.mixed.zach_patches import Patches, Refinements
from ..shared.ranges import Aim, Count, NotNegative, check_parameters
from ..shared.resolutions.resolution_cost import ResolutionCosts
from ..shared.resolutions.steady_costs import make_resolution_costs
from ..solvers.mixed_selection import raise_in_turn
from ..solvers.printed_ascent import PrintedAscent
from ..solvers.smooth_ascent import Ascent, GradientAscent, NewtonAscent
from ..view import View


class Effort(NamedTuple):
    """What the last selection of `zach` without admission took.

    Attributes
    ----------
    groups, variables, steps, passes : int
        Groups in view, variables that they share, steps of the search, and passes over all
        variables.
    loss : float
        Most benefit that sharing may lose by Appendix A, with the budget all spent on splats.
    """

    groups: int = 0
    variables: int = 0
    steps: int = 0
    passes: int = 0
    loss: float = 0.0


_KEPT_BACK = 1e-9
"""Share of the budget that is left to rounding, so that a prediction never exceeds it."""


@dataclass
class Zach:
    """Idea: raise discrete and smooth representations in turn, whichever gains more per cost.

    Discrete nodes start at their coarsest and take Mason and Blake's increments: a finer level, or
    the children in place of the node.  Continuous leaves (groups of trees, or objects) are smooth
    variables.  They are raised along the gradient of benefit, with a barrier before full
    resolution, by a line search that ends where their benefit per cost falls to the next
    increment's.  With `splitting` all groups below a node of their tree share one variable where
    this loses less than ε allows (Algorithm 1).  A group of splats is not drawn if it is smaller
    than `cull_px`; with `admission` nor if it gets less than a splat a tree, or if its splats are
    worth less than setting them up.  Without it, as printed, every group is a variable, and below a
    splat a tree a fraction of its trees is drawn (`zach_fractions`).  Other types are always drawn.
    The search may end after any step: its selection keeps the budget, unless not even the coarsest
    does, which is drawn then.

    Benefit of a patch is ``sqrt(2^(d_max - d)) · S``, S its area in pixels and d its height above
    the leaves; of a group of N trees ``k S² (N / 64) sqrt(x / N · N_splats)``, S² its area.  With
    d counted from the root, as printed, refining would lower benefit; with areas squared, the
    nearest group would outweigh all terrain.  Both are multiplied by importance.  A continuous node
    that has children, or stands below a node with geometry, is refined in steps of its knots.

    Uses: the cost model, projected areas and importance of the nodes in view.

    Parameters: `splitting`, `epsilon`, `barrier`, `cull_px`, `admission` (without it smooth
    variables rise by the gradient as printed), `engine` (how they rise with it: along rays in the
    root of their cost that end at the first bound they meet, or are bent along it, or by the closed
    form), `max_steps` (increments taken together, or one line search, are one step), `aim`.

    Cost per frame: O(n log n) for n nodes in view, and O(V) a step for V variables.

    Reference: Zach, Mantler and Karner, Time-critical rendering of discrete and continuous levels
    of detail, VRST 2002.  Differences: see `smooth_ascent` (gradient in the root of the cost),
    `printed_ascent` (where it begins) and `variable_splitting` (sums over groups for S² and S⁴).
    """

    splitting: bool = True  # the paper's enhanced method
    epsilon: NotNegative = 0.05  # ours; of the groups' greatest benefit; the paper prints no value
    barrier: NotNegative = 1e-3  # ours; "a small constant" in the paper
    cull_px: NotNegative = 2.0  # ours; the paper prints no value
    admission: bool = True  # ours; the paper draws fractions of groups instead
    engine: Literal["bent", "gradient", "newton"] = "bent"  # ours
    max_steps: Count = 256  # ours; some ten; without admission one an increment and full variable
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, hierarchy=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(budget=self.aim <= 1.0, settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, and tell smooth leaves from discrete nodes."""
        check_parameters(self, "zach")
        self._costs = costs = ResolutionCosts(scene, "zach")
        self._budget_ms = self.aim * budget_ms
        tree = Tree(scene)
        solid = (tree.primitives > 0.0) | tree.leaf
        free = tree.first_in(solid, np.arange(len(scene))) < 0
        smooth = scene.continuous & tree.leaf & free
        self._flat = None
        if scene.flat and not smooth.any():
            self._levels_costs = make_resolution_costs(scene, "zach")
            self._flat = make_flat_levels(scene, require_costs(scene, "zach"))
        self._patches = Patches(scene, tree, require_costs(scene, "zach"), solid & ~smooth)
        self._groups = Groups(scene, tree, costs, smooth)
        self._fractions = None
        if not self.admission:
            self._fractions = Fractions(scene, self._groups, require_costs(scene, "zach"))
        self.effort = Effort()

    def select(self, view: View) -> Selection:
        """Return the front and the resolutions that fit the budget."""
        if self._flat is not None:
            return self._select_levels(self._flat, view)
        discrete = self._patches.refinements(view)
        inside, seen = self._groups.seen(view)
        everything = view.at(np.concatenate((discrete.view.ids, seen.ids)))
        left_ms = self._budget_ms * (1.0 - _KEPT_BACK) - discrete.base_ms
        left_ms -= self._costs.fixed_ms(everything)
        epsilon = self.epsilon if self.splitting else None
        if self._fractions is not None and left_ms >= 0.0:
            printed = self._fractions.plan(inside, seen, left_ms, self.cull_px, epsilon)
            if printed.base_ms <= left_ms:
                return self._select_fractions(self._fractions, discrete, printed, left_ms)
        plan = self._groups.plan(inside, seen, left_ms, self.cull_px, epsilon)
        if plan is None:
            ids = seen.ids[~self._groups.optional(seen)]
            resolution = self._costs.lowest(view.at(ids))
            work = Work(len(everything))
        else:
            smooth = self._ascent(plan.weight, plan.low, plan.high)
            left_ms -= plan.setup_ms + float(plan.low.sum())
            _, steps = raise_in_turn(discrete.forest, smooth, left_ms, self.max_steps)
            ids = plan.ids
            resolution = np.maximum(plan.resolution(smooth.x), self._costs.lowest(view.at(ids)))
            work = _work(discrete, plan, smooth, steps)
        patch_ids, level = self._patches.front(discrete)
        ids, detail = np.concatenate((patch_ids, ids)), np.concatenate((level, resolution))
        predicted_ms = self._costs.predict_ms(view.at(ids), detail)
        return Selection(ids.astype(np.int32), detail, work, predicted_ms=predicted_ms)

    def _select_fractions(
        self, fractions: Fractions, discrete: Refinements, plan: FractionPlan, left_ms: float
    ) -> Selection:
        """Return what is drawn of all groups; `left_ms` is what the coarsest terrain leaves."""
        smooth = PrintedAscent(plan.variables, self.barrier)
        begun_ms = plan.base_ms + plan.variables.cost(smooth.r)
        spent_ms, steps = raise_in_turn(
            discrete.forest, smooth, left_ms - begun_ms, self.max_steps, look_ahead=False
        )
        variables, increments = len(smooth.r), discrete.forest.count
        self.effort = Effort(len(plan.seen), variables, steps, smooth.passes, plan.loss)
        comparisons = increments * increments.bit_length() + 2 * smooth.passes * variables
        work = Work(len(discrete.view) + plan.visited, comparisons, steps + smooth.passes)
        patch_ids, level = self._patches.front(discrete)
        ids, detail = fractions.drawn(plan, smooth.r)
        ids, detail = np.concatenate((patch_ids, ids)), np.concatenate((level, detail))
        predicted_ms = self._budget_ms * (1.0 - _KEPT_BACK) - left_ms + begun_ms + spent_ms
        return Selection(ids.astype(np.int32), detail, work, predicted_ms=predicted_ms)

    def _select_levels(self, levels: FlatLevels, view: View) -> Selection:
        """Return the levels of a flat scene that has no smooth half."""
        seen = view if view.inside.all() else view.at(view.ids[view.inside])
        costs, n = self._levels_costs, len(seen)
        least_ms = costs.least_ms(seen)
        left_ms = self._budget_ms * (1.0 - _KEPT_BACK) - least_ms
        if left_ms < 0.0:
            return Selection(seen.ids, levels.coarsest(seen), Work(n), predicted_ms=least_ms)
        increments, nothing = levels.increments(seen), np.zeros(0)
        smooth = self._ascent(nothing, nothing, nothing)
        _, steps = raise_in_turn(increments, smooth, left_ms, self.max_steps)
        detail = levels.detail(seen, increments)
        count = increments.count
        work = Work(n, count * count.bit_length(), steps + smooth.passes)
        return Selection(seen.ids, detail, work, predicted_ms=costs.predict_ms(seen, detail))

    def _ascent(self, weight: FloatArray, low: FloatArray, high: FloatArray) -> Ascent:
        if self.engine == "newton":
            return NewtonAscent(weight, low, high)
        return GradientAscent(weight, low, high, barrier=self.barrier, bent=self.engine == "bent")


def _work(discrete: Refinements, plan: Plan, smooth: Ascent, steps: int) -> Work:
    """Return what was done: two comparisons a variable and pass, and the sorting of increments."""
    increments = discrete.forest.count
    comparisons = plan.comparisons + increments * increments.bit_length()
    comparisons += 2 * smooth.passes * len(plan.weight)
    return Work(len(discrete.view) + plan.visited, comparisons, steps + smooth.passes)
