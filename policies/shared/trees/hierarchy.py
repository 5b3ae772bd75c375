"""What policies that choose fronts need to know of a hierarchy, and what a frame's choices add.

A front is told by the set of *refined* nodes: those that give way to their children, or are joined
by them.  The set holds with a node all of its ancestors.  A node without geometry that has children
stands for nothing, so that it is refined wherever it is reached.
"""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray
from ....models.machine.frame_cost import FrameCost
from ....models.scene.benefit import BASE_ERROR
from ....models.scene.scene import Scene
from ....models.scene.tree import Tree
from ...view import View


class Hierarchy:
    """Derived from a scene, once a replay.

    Attributes
    ----------
    scene : Scene
    tree : Tree
    inner : (N,) bool
        Nodes with children.
    empty : (N,) bool
        Inner nodes without geometry.
    error_m : (N,) float64
        Geometric error of each node as drawn, in metres.
    layers : list of (·,) int
        Nodes by depth, the roots first.
    """

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        self.scene = scene
        self.tree = tree = Tree(scene)
        self.inner = ~tree.leaf
        self.empty = self.inner & (tree.primitives == 0)
        self.error_m = levels.error_m[levels.start[:-1]][scene.type_index] * scene.scale
        self.layers: list[IntArray] = [
            np.flatnonzero(tree.depth == depth) for depth in range(int(tree.depth.max()) + 1)
        ]

    def sum_children(self, values: FloatArray) -> FloatArray:
        """Return each node's sum of values over its children, (N,)."""
        child = self.scene.child_ids
        total = np.bincount(self.scene.parent[child], values[child], minlength=len(values))
        return total.astype(np.float64, copy=False)

    def sum_below(self, values: FloatArray) -> FloatArray:
        """Return each node's sum of values over itself and all below it, (N,)."""
        total = values.copy()
        for layer in self.layers[:0:-1]:
            total += np.bincount(self.scene.parent[layer], total[layer], minlength=len(total))
        return total

    def raise_to_children(self, values: FloatArray) -> FloatArray:
        """Return values raised so that none is below a child's, (N,)."""
        highest = values.copy()
        for layer in self.layers[:0:-1]:
            np.maximum.at(highest, self.scene.parent[layer], highest[layer])
        return highest

    def fold_empty(self, more: FloatArray) -> FloatArray:
        """Return what refining each node adds, together with the empty nodes right below it."""
        if not self.empty.any():
            return more
        total = more.copy()
        for layer in self.layers[:0:-1]:
            passed = layer[self.empty[layer]]
            np.add.at(total, self.scene.parent[passed], total[passed])
        total[self.empty] = 0.0
        return total

    def waits(self, view: View, *, for_all: bool = False) -> BoolArray:
        """Return which nodes wait for a child in the frustum (or any child) to be in memory, (N,).

        An empty child counts as in memory if nothing below it has to be waited for.
        """
        resident = view.state.residency
        waits = np.zeros(len(self.scene), dtype=np.bool_)
        if resident is None:
            return waits
        absent = ~resident if for_all else view.state.inside & ~resident
        for layer in self.layers[:0:-1]:
            passed = layer[self.empty[layer]]
            absent[passed] = waits[passed]
            waits[self.scene.parent[layer[absent[layer]]]] = True
        return waits

    def close(self, view: View, wished: BoolArray) -> BoolArray:
        """Return the wished nodes, and empty ones, whose ancestors are refined too, (N,)."""
        refined = (wished & self.inner) | self.empty
        first = refined[view.ids]
        refined[self.layers[0]] = False
        refined[view.ids] = first
        for layer in self.layers[1:]:
            refined[layer] &= refined[self.scene.parent[layer]]
        return refined

    def front(self, view: View, refined: BoolArray) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of what a closed set of refined nodes draws in the frustum."""
        scene = self.scene
        drawn = refined[scene.parent]
        drawn[self.layers[0]] = False
        drawn[view.ids] = True
        drawn &= view.state.inside & (scene.additive | ~refined)
        ids = np.flatnonzero(drawn).astype(np.int32)
        return ids, scene.continuous[ids].astype(np.float64)

    def coarsest(self, view: View) -> IntArray:
        """Return what is drawn in the frustum where nothing but empty nodes is refined."""
        return self.front(view, self.close(view, np.zeros_like(self.inner)))[0]


class NodeCosts:
    """GPU time of drawing nodes, as the scene's cost model believes.

    A change of state is charged to the node that alone has a type; a type of several nodes is
    charged once for every frame.
    """

    def __init__(self, scene: Scene, costs: FrameCost) -> None:
        levels = scene.types.levels
        self._costs = costs
        self._row = levels.start[:-1][scene.type_index]
        users = np.bincount(scene.type_index, minlength=len(levels.level_count))
        self._alone_ms = costs.model.unit_ms("state_changes") * (users[scene.type_index] == 1)
        self._shared = int(np.count_nonzero(users > 1))

    def node_ms(self, view: View) -> FloatArray:
        """Return what each node of a view adds to the frame, (m,)."""
        alone_ms = self._alone_ms[view.ids] * self._costs.draws_of(view)
        return self._costs.objects_ms(self._row[view.ids], view) + alone_ms

    def fixed_ms(self, view: View) -> float:
        """Return what the frame takes whatever is drawn: an upper bound as to shared types."""
        return self._costs.fixed_ms(view.viewport_px, self._shared * self._costs.model.passes)


@dataclass(frozen=True, slots=True)
class Gains:
    """Cost and benefit of each node in view, and what refining it adds to both; (N,) each.

    Attributes
    ----------
    cost_ms, benefit : of drawing the node; 0 outside the frustum
    children_ms, children_benefit : of drawing its children
    more_ms, more_benefit : of refining it; 0 of leaves
    visited : int
        Nodes in view.
    """

    cost_ms: FloatArray
    benefit: FloatArray
    children_ms: FloatArray
    children_benefit: FloatArray
    more_ms: FloatArray
    more_benefit: FloatArray
    visited: int


def gains(hierarchy: Hierarchy, costs: NodeCosts, view: View) -> Gains:
    """Return what drawing and refining each node of this frame costs and brings.

    Benefit is the score's: area · importance · (1 - 0.5 / samples), summed over the leaves in view,
    a leaf below the node having the node's samples by its share of the primitives below.  Below one
    sample a leaf the score ends at 0, while this goes on falling.
    """
    scene, tree = hierarchy.scene, hierarchy.tree
    seen = view.at(np.flatnonzero(view.state.inside))
    cost_ms = np.zeros(len(scene))
    cost_ms[seen.ids] = costs.node_ms(seen)
    unit = tree.leaf | (scene.additive & ~hierarchy.empty)
    weight = np.zeros(len(scene))
    weight[seen.ids] = seen.area_px * scene.importance[seen.ids]
    weight[~unit] = 0.0
    primitives = np.maximum(tree.primitives, 1.0)
    per_primitive = weight / primitives
    single = weight - BASE_ERROR * per_primitive
    shrink = np.maximum(tree.leaf_primitives, 1.0) / primitives
    stands_for = hierarchy.sum_below(weight)
    stands_for -= BASE_ERROR * shrink * hierarchy.sum_below(per_primitive)
    benefit = np.where(tree.leaf | scene.additive, single, stands_for)
    benefit[hierarchy.empty] = 0.0
    children_ms = hierarchy.sum_children(cost_ms)
    children = hierarchy.sum_children(benefit)
    stays = scene.additive | tree.leaf
    more_ms = children_ms - np.where(stays, 0.0, cost_ms)
    more = children - np.where(stays, 0.0, benefit)
    return Gains(cost_ms, benefit, children_ms, children, more_ms, more, len(seen.ids))
