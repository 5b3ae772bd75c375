"""The smooth half of a mixed scene as printed: every group in view, or a fraction of its trees."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray
from ....base.errors import InputError
from ....models.machine.frame_cost import FrameCost
from ....models.scene.scene import Scene
from ...solvers.allocation import allocate
from ...solvers.printed_ascent import SmoothVariables
from ...solvers.variable_splitting import split_variables
from ...view import View
from .zach_groups import Groups

_START = 1e-3  # of one splat of the largest group: where the ascent begins
_WHOLE = 1e-9  # by which a number of splats may miss a whole one


@dataclass(frozen=True, slots=True)
class FractionPlan:
    """Smooth variables of one frame.

    Attributes
    ----------
    seen : View
        The u groups that are large enough.
    base_ms : float
        What is paid whatever the resolutions: for objects that are no groups of splats.
    variables : SmoothVariables
    owner : (u,) int
        Variable of each group.
    visited : int
    loss, allowed : float
        Most benefit that sharing variables may lose, and what ε allows.
    """

    seen: View
    base_ms: float
    variables: SmoothVariables
    owner: IntArray
    visited: int
    loss: float
    allowed: float


class Fractions:
    """Every group in view is a variable; what it gets decides how many of its trees are drawn.

    Section 5.4: "If the point budget assigned to a group of trees is not sufficient to display each
    tree with at least one splat, only the corresponding fraction of the group is rendered."  A tree
    that is not drawn is not set up either, so that a group's cost rises from nothing, by a tree's
    set-up and one splat, until each tree has a splat, and by splats from there on.  (With set-ups
    of all trees in view paid in any case, as the printed cost may be read, they alone are many
    times the budget.)  Whole splats are drawn, of whole trees: what is left over of a resolution is
    predicted, and not spent.
    """

    def __init__(self, scene: Scene, groups: Groups, costs: FrameCost) -> None:
        """Raise InputError if the machine has a roofline, or terms of the view that read levels."""
        if costs.model.has_roofline or not costs.linear_in_detail:
            raise InputError(
                "zach: expected a machine of linear costs for admission=false, got one with a "
                "roofline or rasterized triangles, or several cameras; leave admission on"
            )
        self._scene, self._groups, self._costs = scene, groups, costs
        levels = scene.types.levels
        kinds = np.arange(len(levels.level_count), dtype=np.int32)
        whole = groups.floor
        row, part = levels.position(kinds, whole)
        at_whole = levels.interpolate(costs.level_ms, row, part)
        finest_ms = costs.level_ms[levels.start[:-1]]
        lowest_ms = costs.level_ms[levels.start[1:] - 1]
        # Splats: the line through one a tree and full detail; others: through lowest and finest.
        low = np.where(whole > 0.0, whole, levels.min_resolution)
        low_ms = np.where(whole > 0.0, at_whole, lowest_ms)
        rise = np.maximum(finest_ms - low_ms, 0.0)
        self._full_ms = np.divide(rise, 1.0 - low, out=np.zeros(len(low)), where=low < 1.0)
        self._setup_ms = np.maximum(finest_ms - self._full_ms, 0.0)
        self._whole = np.where(whole > 0.0, whole, 1.0)
        self._splats = groups.splats

    def plan(
        self, inside: BoolArray, seen: View, budget_ms: float, cull_px: float, epsilon: float | None
    ) -> FractionPlan:
        """Return the variables of a frame; the arguments are those of `Groups.plan`."""
        optional = self._groups.optional(seen)
        large = np.flatnonzero(~optional | (seen.area_px >= cull_px * cull_px))
        drawn = np.zeros(len(inside), dtype=np.bool_)
        drawn[np.flatnonzero(inside)[large]] = True
        seen, optional = seen.at(seen.ids[large]), optional[large]
        kind = seen.type_index
        setup, full = self._setup_ms[kind], self._full_ms[kind]
        # What is no group is set up in any case.
        base_ms = float(setup[~optional].sum()) + self._costs.anyway_ms(seen)
        setup = np.where(optional, setup, 0.0)
        splats = float(self._splats[kind].max(initial=1.0))
        lowest = self._scene.types.levels.min_resolution[kind]
        start = np.where(optional, _START / splats, lowest)
        benefit = self._groups.value(seen)
        first, visited, loss, allowed = np.arange(len(kind)), 0, 0.0, 0.0
        if epsilon is not None and not self._scene.flat and len(kind):
            weight = np.divide(benefit, np.sqrt(full), out=np.zeros(len(full)), where=full > 0.0)
            share = _shares(weight, full * start, full, budget_ms)
            lose = epsilon * float((weight * np.sqrt(share)).sum())
            leaves = self._groups.leaves
            split = split_variables(leaves, drawn, weight, full * start, full, share, lose)
            first, visited = split.start, split.visited
            loss, allowed = split.loss, split.allowed
        owner = np.zeros(len(kind), dtype=np.int64)
        owner[first] = 1
        values = (benefit, setup, full, np.ones(len(kind)))
        benefit, setup, full, members = (np.add.reduceat(v, first) if len(v) else v for v in values)
        # The least of the resolutions from which trees are whole: dearer than each by itself.
        whole = np.minimum.reduceat(self._whole[kind], first) if len(kind) else start
        start = np.maximum.reduceat(start, first) if len(kind) else start
        variables = SmoothVariables(benefit, setup, full, whole, start, members)
        count = len(seen) + visited
        return FractionPlan(seen, base_ms, variables, np.cumsum(owner) - 1, count, loss, allowed)

    def drawn(self, plan: FractionPlan, r: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of what is drawn: whole splats of whole trees."""
        kind = plan.seen.type_index
        resolution, splats = r[plan.owner], self._splats[kind]
        given = resolution * splats * (1.0 + _WHOLE)
        trees = np.maximum(self._whole[kind] * splats, 1.0)
        # Below a splat a tree so many trees as there are splats; above it as many splats for each.
        each = np.floor(given / trees) * trees
        given = np.where(given < trees, np.floor(given), each)
        detail = np.divide(given, splats, out=resolution.copy(), where=splats > 0.0)
        # A type that has no level of fewer trees than all is drawn whole or not at all.
        least = self._scene.types.levels.min_resolution[kind] * (1.0 - _WHOLE)
        kept = (splats <= 0.0) | ((given >= 1.0) & (detail >= least))
        return plan.seen.ids[kept], np.minimum(detail[kept], 1.0)


def _shares(weight: FloatArray, low: FloatArray, high: FloatArray, budget_ms: float) -> FloatArray:
    """Return what each group would best spend on splats if it were the whole budget, (u,)."""
    budget_ms = max(budget_ms, 2.0 * float(low.sum()))
    ones = np.ones(len(weight))
    return allocate(0.5 * weight, ones, budget_ms, power=0.5, low=low, high=high).x
