"""What an optimiser may choose for each object in view: cost and benefit of every alternative.

In a flat scene an object's alternatives are its levels (the knots of a continuous type).  In a
hierarchy the objects are the roots, and the alternatives of a root are the fronts of uniform depth
below it, and then the coarsest front with its continuous nodes at coarser knots.  What a front
brings is summed over the leaves that it stands for, as the score is: spheres of inner nodes are
loose, and those of children may cover less than their parent's.  Nodes that stand
for nothing, having children and no geometry, count for no depth and are never drawn.  Column 0 is
the finest; a row that has fewer alternatives ends in infinite costs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray
from ....base.errors import InputError
from ....models.machine.frame_cost import FrameCost
from ....models.scene.benefit import BASE_ERROR, level_primitives
from ....models.scene.scene import Scene
from ...solvers.smooth_choice import SmoothChoice
from ...view import View
from ..trees.hierarchy import Hierarchy


@dataclass(frozen=True, slots=True)
class Offer:
    """Alternatives of one frame.

    Attributes
    ----------
    cost_ms : (n, L) float64
        Marginal GPU time; infinite where a row has no such alternative.
    benefit : (n, L) float64
        Size times accuracy times `weight`, of a front summed over the leaves below its nodes.
    fixed_ms : float
        GPU time that the frame takes whatever is chosen; an upper bound as to state changes.
    objects : (n,) int32
        The candidate of each row.
    size : (n,) float64
        Projected area times `weight` of each candidate.
    samples : (n, L) float64
        Primitives of each alternative (flat scenes; a hierarchy's fronts have none of their own).
    """

    cost_ms: FloatArray
    benefit: FloatArray
    fixed_ms: float
    objects: IntArray
    size: FloatArray
    samples: FloatArray

    def smooth(self, soft: BoolArray) -> SmoothChoice:
        """Return the choice of levels and, for the `soft` rows, resolutions."""
        return SmoothChoice(self.cost_ms, self.benefit, self.samples, self.size, soft)


Weight: TypeAlias = Callable[[View], FloatArray]
"""Benefit of each node beyond size and accuracy, such as importance times focus, (m,)."""


def importance(view: View) -> FloatArray:
    """Return the weight that the simulator's score gives to nodes (see `Weight`), (m,)."""
    return view.scene.importance[view.ids]


def require_costs(scene: Scene, policy: str) -> FrameCost:
    """Return what frames of the scene cost; raise InputError if it has no cost model."""
    if scene.costs is None:
        raise InputError(
            f"{policy}: expected a scene with a cost model, got none; bind one with with_costs"
        )
    return FrameCost(scene.costs, scene.types.levels)


def make_choices(scene: Scene, costs: FrameCost, exponent: float) -> "LevelChoices | _Fronts":
    """Return the alternatives of a scene; accuracy is ``1 - BASE_ERROR / samples^exponent``."""
    if scene.flat:
        return LevelChoices(scene, costs, exponent)
    return _Fronts(scene, costs, exponent)


class LevelChoices:
    """Levels of flat scenes, as tables of one row a type."""

    def __init__(self, scene: Scene, costs: FrameCost, exponent: float) -> None:
        levels = scene.types.levels
        self._costs = costs
        self._continuous = levels.continuous
        width = int(levels.level_count.max())
        lacking = np.arange(width) >= levels.level_count[:, None]
        self._lacking = lacking if lacking.any() else None
        self._rows = rows = levels.rows_by_type()
        self._samples = level_primitives(levels)[rows]
        self._accuracy = accuracy_of(self._samples, exponent)
        self._resolution = levels.resolution[rows]

    def offer(self, view: View, weight: Weight) -> Offer:
        """Return the levels of a view's candidates."""
        kind = view.type_index
        cost_ms = self._costs.objects_ms(self._rows[kind], view)
        if self._lacking is not None:
            cost_ms[self._lacking[kind]] = np.inf
        size = view.area_px * weight(view)
        benefit = size[:, None] * self._accuracy[kind]
        fixed_ms = self._costs.fixed_ms(
            view.viewport_px, self._costs.types_drawn(kind, view), len(view)
        )
        return Offer(cost_ms, benefit, fixed_ms, view.ids, size, self._samples[kind])

    def between(self, view: View, column: IntArray, share: FloatArray) -> FloatArray:
        """Return details that lie a share of the way from a column to the next finer one, (n,)."""
        kind = view.type_index
        low = self._resolution[kind, column]
        high = self._resolution[kind, np.maximum(column - 1, 0)]
        level = column.astype(np.float64)
        return np.where(self._continuous[kind], low + share * (high - low), level)

    def drawn(self, view: View, column: IntArray, keep: BoolArray) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of the chosen columns of the kept rows."""
        detail = self.between(view, column, np.zeros(len(column)))
        return (view.ids, detail) if keep.all() else (view.ids[keep], detail[keep])


class _Fronts:
    """Fronts of uniform depth below each root: column c is the front c levels above the deepest.

    Columns behind a root's coarsest front are that front at coarser knots.
    """

    def __init__(self, scene: Scene, costs: FrameCost, exponent: float) -> None:
        self._scene, self._costs = scene, costs
        levels, self._exponent = scene.types.levels, exponent
        self._hierarchy = Hierarchy(scene)
        tree = self._hierarchy.tree
        self._samples = np.maximum(level_primitives(levels), 1.0)
        self._first_row = levels.start[:-1][scene.type_index]
        self._solid = tree.leaf | (tree.primitives > 0.0)
        root, depth = np.arange(len(scene)), np.zeros(len(scene), dtype=np.int32)
        for layer in range(1, int(tree.depth.max()) + 1):
            nodes = np.flatnonzero(tree.depth == layer)
            above = scene.parent[nodes]
            root[nodes], depth[nodes] = root[above], depth[above] + self._solid[above]
        self._root, self._depth = root, depth
        # A node is in the front of depth d if it lies there, or above it and nothing replaces it.
        self._stays = tree.leaf | scene.additive
        self._knots = np.where(scene.continuous & (depth == 0), scene.level_count, 1)
        self._deepest, self._coarser = np.zeros_like(depth), np.zeros_like(depth)
        np.maximum.at(self._deepest, root[self._solid], depth[self._solid])
        np.maximum.at(self._coarser, root[self._solid], self._knots[self._solid] - 1)
        self._width = int((self._deepest + self._coarser).max()) + 1

    def offer(self, view: View, weight: Weight) -> Offer:
        """Return the fronts below a view's roots, over their nodes in the frustum."""
        n, width = len(view.ids), self._width
        row_of = np.full(len(self._scene), -1, dtype=np.int32)
        row_of[view.ids] = np.arange(n)
        nodes = np.flatnonzero(view.state.inside & (row_of[self._root] >= 0) & self._solid)
        seen = view.at(nodes)
        worth, lost = self._worth(seen, seen.area_px * weight(seen))
        row = row_of[self._root[nodes]]
        cost_ms, benefit = np.full((n, width), np.inf), np.zeros((n, width))
        deepest, coarser = self._deepest[view.ids], self._coarser[view.ids]
        for depth in range(-int(self._coarser.max()), int(self._deepest.max()) + 1):
            level = self._level_row(nodes, depth)
            node_ms = self._costs.objects_ms(level, seen)
            member = self._member(nodes, max(depth, 0))
            has = (depth <= deepest) & (-depth <= coarser)
            total = np.bincount(row[member], node_ms[member], minlength=n)
            gain = worth - lost / self._samples[level] ** self._exponent
            gain = np.maximum(gain, 0.0, out=gain)[member]
            cost_ms[has, deepest[has] - depth] = total[has]
            benefit[has, deepest[has] - depth] = np.bincount(row[member], gain, minlength=n)[has]
        size = view.area_px * weight(view)
        # Every node may be of a type of its own, and which are drawn is open.
        types = distinct(view.scene.type_index[view.state.inside]) * self._costs.model.passes
        fixed_ms = self._costs.fixed_ms(view.viewport_px, types)
        return Offer(cost_ms, benefit, fixed_ms, view.ids, size, np.zeros_like(benefit))

    def _worth(self, seen: View, size: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what nodes bring with endless samples, and what they lose with one, (m,).

        Size times accuracy of the leaves in view, a leaf below a node having of the node's samples
        its share by the primitives below.
        """
        below, tree, exponent = self._hierarchy, self._hierarchy.tree, self._exponent
        unit = tree.leaf | (self._scene.additive & ~below.empty)
        leaf_size = np.zeros(len(self._scene))
        leaf_size[seen.ids] = size
        leaf_size[~unit] = 0.0
        lost = BASE_ERROR * leaf_size / np.maximum(tree.primitives, 1.0) ** exponent
        alone = (tree.leaf | self._scene.additive)[seen.ids]
        samples = np.where(alone, tree.primitives[seen.ids], tree.leaf_primitives[seen.ids])
        worth = np.where(alone, leaf_size[seen.ids], below.sum_below(leaf_size)[seen.ids])
        all_lost = np.where(alone, lost[seen.ids], below.sum_below(lost)[seen.ids])
        return worth, all_lost * np.maximum(samples, 1.0) ** exponent

    def _level_row(self, nodes: IntArray, depth: int | IntArray) -> IntArray:
        """Return the row of each node's level: coarser knots where the depth is negative."""
        return self._first_row[nodes] + np.clip(-depth, 0, self._knots[nodes] - 1)

    def _member(self, nodes: IntArray, depth: int | IntArray) -> BoolArray:
        at = self._depth[nodes]
        return self._solid[nodes] & ((at == depth) | ((at < depth) & self._stays[nodes]))

    def drawn(self, view: View, column: IntArray, keep: BoolArray) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of the chosen fronts of the kept roots."""
        scene = self._scene
        depth = np.zeros(len(scene), dtype=np.int32)
        kept = np.zeros(len(scene), dtype=np.bool_)
        depth[view.ids], kept[view.ids] = self._deepest[view.ids] - column, keep
        wanted = depth[self._root]
        nodes = np.arange(len(scene), dtype=np.int32)
        ids = nodes[kept[self._root] & self._member(nodes, np.maximum(wanted, 0))]
        resolution = scene.types.levels.resolution[self._level_row(ids, wanted[ids])]
        return ids, np.where(scene.continuous[ids], resolution, 0.0)


def distinct(kind: IntArray) -> int:
    """Return how many types there are among those of some nodes."""
    return int(np.count_nonzero(np.bincount(kind)))


def accuracy_of(samples: FloatArray, exponent: float) -> FloatArray:
    """Return ``1 - BASE_ERROR / samples^exponent``, of at least one sample."""
    return 1.0 - BASE_ERROR / np.maximum(samples, 1.0) ** exponent
