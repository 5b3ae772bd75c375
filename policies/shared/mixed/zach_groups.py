"""The smooth half of a mixed scene: which groups are drawn in a frame, and what they share."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray
from ....base.predictors import LEVEL_PREDICTORS
from ....models.scene.benefit import level_primitives
from ....models.scene.levels import LevelTable
from ....models.scene.scene import Scene
from ....models.scene.tree import Tree
from ...solvers.admission import admit
from ...solvers.variable_splitting import LeafTree, split_variables
from ...view import View
from ..levels.choices import require_costs
from ..resolutions.resolution_cost import ResolutionCosts

_SPLATS = LEVEL_PREDICTORS.index("splats")
_DRAW_CALLS = LEVEL_PREDICTORS.index("draw_calls")
_K = 1.0 / 16.0  # the paper's weight of vegetation against terrain
_TREES = 64.0  # the paper's largest group
_LEAST_WEIGHT = 1e-12  # of the greatest; so that what is worth nothing is raised last, not never


@dataclass(frozen=True, slots=True)
class Plan:
    """Smooth variables of one frame, in milliseconds beyond what drawing them at all costs.

    Attributes
    ----------
    ids : (u,) int32
        Groups drawn.
    setup_ms : float
        What they cost whatever their resolution.
    floor : (u,) float64
        The resolution that a group has at least.
    weight, low, high : (V,) float64
        Variables: factor of the root of the cost, and bounds of the cost.
    owner : (u,) int
        Variable of each group.
    visited, comparisons : int
    """

    ids: IntArray
    setup_ms: float
    floor: FloatArray
    weight: FloatArray
    low: FloatArray
    high: FloatArray
    owner: IntArray
    visited: int
    comparisons: int

    def resolution(self, x: FloatArray) -> FloatArray:
        """Return the resolution of each group from the cost of each variable, (u,)."""
        share = np.divide(x, self.high, out=np.ones(len(x)), where=self.high > 0.0)
        return np.clip(share[self.owner], self.floor, 1.0)


class Groups:
    """Continuous leaves below nothing but nodes without geometry, derived once a replay.

    Benefit is ``k S² (N / 64) sqrt(x / N · N_splats)``, ``x / N`` the resolution of each of N
    trees, one a draw call.  S is the extent on the screen, S² the projected area: only then is the
    sum over a node's groups bounded by the node's own, as Appendix A has it.

    Attributes
    ----------
    leaves : LeafTree
    splats, floor : (K,) float64
        Of each type: splats at full detail, and the resolution at which each tree has one; 0 where
        there are no splats.
    """

    def __init__(self, scene: Scene, tree: Tree, costs: ResolutionCosts, member: BoolArray) -> None:
        self._scene, self._costs = scene, costs
        levels = scene.types.levels
        finest = levels.counts[levels.start[:-1]]
        trees = np.maximum(finest[:, _DRAW_CALLS], 1.0)
        primitives = level_primitives(levels)[levels.start[:-1]]
        splats = finest[:, _SPLATS]
        # A type without splats has no floor of its own and may not be left out.
        floor = np.divide(trees, splats, out=np.zeros(len(splats)), where=splats > 0.0)
        self.leaves = LeafTree(scene, tree, member)
        self.splats, self.floor = splats, np.minimum(floor, 1.0)
        self._factor = _K / _TREES * np.sqrt(trees * primitives)
        # Below a splat a tree nothing is admitted, so that the lines need not lie above that part.
        self._frame_cost = require_costs(scene, "zach")
        level_ms = self._frame_cost.level_ms
        chord = _line_above(levels, level_ms, levels.min_resolution)
        admitted = np.maximum(self.floor, levels.min_resolution)
        self._too_high = chord - _line_above(levels, level_ms, admitted)
        self._root = root = self.leaves.leaves.copy()
        while (below := scene.parent[root] >= 0).any():
            root[below] = scene.parent[root[below]]

    def seen(self, view: View) -> tuple[BoolArray, View]:
        """Return which leaves are in view, (U,), and the view of them."""
        live = np.zeros(len(self._scene), dtype=np.bool_)
        live[view.ids] = True
        leaves = self.leaves.leaves
        inside = view.state.inside[leaves] & live[self._root]
        return inside, view.at(leaves[inside])

    def optional(self, seen: View) -> BoolArray:
        """Return which nodes may be left out: groups of splats, (m,)."""
        return self.floor[seen.type_index] > 0.0

    def value(self, seen: View) -> FloatArray:
        """Return the benefit of each group at full detail, (m,), never 0."""
        value = self._factor[seen.type_index] * seen.area_px * self._scene.importance[seen.ids]
        return np.maximum(value, _LEAST_WEIGHT * value.max(initial=1e-300))

    def plan(
        self, inside: BoolArray, seen: View, budget_ms: float, cull_px: float, epsilon: float | None
    ) -> Plan | None:
        """Return the variables of a frame, or None if the budget does not pay for their lowest.

        Groups whose extent is below `cull_px` are not drawn.  With `epsilon` the groups of a node
        may share a variable; it is a share of the greatest benefit that the budget can buy.
        """
        kind = seen.type_index
        optional = self.optional(seen)
        setup, _, full, floor = self._costs.stretches(seen)
        setup, full = (setup, full) - self._too_high[:, kind] * self._frame_cost.draws_of(seen)
        floor = np.minimum(np.maximum(floor, self.floor[kind]), 1.0)
        value = self.value(seen)
        weight = np.divide(value, np.sqrt(full), out=np.zeros(len(full)), where=full > 0.0)
        large = ~optional | (seen.area_px >= cull_px * cull_px)
        at = np.flatnonzero(large)
        low = full * floor
        admission = admit(setup[at], low[at], full[at], weight[at], optional[at], budget_ms)
        if admission is None:
            return None
        at = at[admission.drawn]
        low, full, floor, weight = low[at], full[at], floor[at], weight[at]
        start, visited = np.arange(len(at)), 0
        if epsilon is not None and not self._scene.flat:
            drawn = np.zeros(len(inside), dtype=np.bool_)
            drawn[np.flatnonzero(inside)[at]] = True
            share = np.clip(admission.scale * np.square(weight), low, full)
            lose = epsilon * float((weight * np.sqrt(share)).sum())
            splitting = split_variables(self.leaves, drawn, weight, low, full, share, lose)
            start, visited = splitting.start, splitting.visited
        return Plan(
            seen.ids[at],
            float(setup[at].sum()),
            floor,
            *_variables(start, weight, floor, full),
            len(seen) + visited,
            admission.comparisons,
        )


def _line_above(levels: LevelTable, column: FloatArray, low: FloatArray) -> FloatArray:
    """Return start and slope of each type's line above its knots from resolution `low` on, (2, K).

    The slope is that of the chord from there to full detail.
    """
    kinds = np.arange(len(low), dtype=np.int32)
    # A discrete type's detail is a level; none has groups, so that its finest will do.
    detail = np.where(levels.continuous, low, 0.0)
    at_low = levels.interpolate(column, *levels.position(kinds, detail))
    rise = np.maximum(column[levels.start[:-1]] - at_low, 0.0)
    slope = np.divide(rise, 1.0 - low, out=np.zeros(len(low)), where=low < 1.0)
    kind = levels.type_of_level
    gap = column - slope[kind] * levels.resolution
    gap[levels.resolution < low[kind] * (1.0 - 1e-9)] = -np.inf
    return np.stack((np.maximum.reduceat(gap, levels.start[:-1]), slope))


def _variables(
    start: IntArray, weight: FloatArray, floor: FloatArray, full: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Return weight, least and greatest cost of variables over groups, and the variable of each."""
    owner = np.zeros(len(weight), dtype=np.int64)
    owner[start] = 1
    owner = np.cumsum(owner) - 1
    if len(start) == len(weight):
        return weight, full * floor, full, owner
    high = np.add.reduceat(full, start)
    value = np.add.reduceat(weight * np.sqrt(full), start)
    shared = np.divide(value, np.sqrt(high), out=np.zeros(len(high)), where=high > 0.0)
    return shared, np.maximum.reduceat(floor, start) * high, high, owner
