"""The discrete half of a mixed scene: representations, and the increments of one frame."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray
from ....models.machine.frame_cost import FrameCost
from ....models.scene.scene import Scene
from ....models.scene.tree import Tree
from ...solvers.increment_forest import IncrementForest
from ...view import View


@dataclass(frozen=True, slots=True)
class Refinements:
    """Discrete nodes in view, one a row, and the increments that refine them.

    Attributes
    ----------
    view : View
        Of the m nodes, by depth.
    above : (m,) int
        Row of the nearest node above that is in view, -1 for none.
    base_ms : float
        GPU time of the coarsest front.
    forest : IncrementForest
        Columns of a row: one level finer, and so on; last, the children in place of the node.
    """

    view: View
    above: IntArray
    base_ms: float
    forest: IncrementForest


class Patches:
    """Nodes whose representations are discrete, derived from a scene once a replay.

    A node has its levels, coarsest first, then its children instead of itself (or beside itself,
    where it stays drawn).  Benefit of a representation is ``sqrt(2^(d_max - d)) · S``, d its height
    in such steps above the finest one below it, d_max that of the tree.  S is the area in view, the
    sum over the leaves in view, so that a node half out of view does not count in full.
    """

    def __init__(self, scene: Scene, tree: Tree, costs: FrameCost, member: BoolArray) -> None:
        self._scene, self._costs = scene, costs
        n, depth = len(scene), tree.depth
        layers = [np.flatnonzero(depth == d) for d in range(int(depth.max()) + 1)]
        above = tree.first_in(member, np.arange(n))
        root, steps = np.arange(n), np.zeros(n, dtype=np.int64)
        for layer in layers[1:]:
            root[layer] = root[scene.parent[layer]]
            has = layer[above[layer] >= 0]
            steps[has] = steps[above[has]] + 1
        height = np.zeros(n, dtype=np.int64)
        coarser = scene.level_count - 1
        for layer in layers[:0:-1]:
            has = layer[member[layer] & (above[layer] >= 0)]
            np.maximum.at(height, above[has], height[has] + coarser[has] + 1)
        highest = np.zeros(n, dtype=np.int64)
        nodes = np.flatnonzero(member)
        np.maximum.at(highest, root[nodes], height[nodes] + coarser[nodes])
        self._nodes = nodes[np.argsort(steps[nodes], kind="stable")].astype(np.int32)
        self._above, self._depth, self._root = above, steps, root
        self._exponent = (highest[root] - height).astype(np.float64)

    def refinements(self, view: View) -> Refinements:
        """Return the discrete nodes in view below the view's roots."""
        seen, above = self._in_view(view)
        level = self._level(seen)
        row = self._scene.types.levels.start[seen.type_index][:, None] + level
        cost_ms = self._costs.objects_ms(row, seen)
        has_children = np.bincount(above[above >= 0], minlength=len(above)) > 0
        stays = self._scene.additive[seen.ids]
        layers = self._layers(seen.ids)
        area = self._area(seen, above, layers, whole=stays | ~has_children)
        exponent = self._exponent[seen.ids][:, None]
        benefit = np.exp2(0.5 * (exponent - level)) * area[:, None]
        void = np.column_stack((level[:, 1:] == level[:, :-1], ~has_children))
        gives_way = np.where(stays, 0.0, 1.0)
        more_ms, gain = _steps(cost_ms, above, gives_way), _steps(benefit, above, gives_way)
        forest = IncrementForest(more_ms, gain, void, above, layers)
        return Refinements(seen, above, float(cost_ms[above < 0, 0].sum()), forest)

    def front(self, refinements: Refinements) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of what is drawn after the increments that were taken."""
        seen, taken = refinements.view, refinements.forest.taken
        refined = taken[:, -1]
        reached = np.where(refinements.above >= 0, refined[refinements.above], np.True_)
        drawn = reached & (~refined | self._scene.additive[seen.ids])
        level = self._last_level(seen) - taken[:, :-1].sum(axis=1)
        levels, kind = self._scene.types.levels, seen.type_index
        knot = levels.resolution[levels.start[kind] + level.astype(np.int64)]
        detail = np.where(levels.continuous[kind], knot, level)
        return seen.ids[drawn], detail[drawn]

    def _in_view(self, view: View) -> tuple[View, IntArray]:
        """Return the nodes in view, by depth, and the row of the nearest one above each."""
        inside = view.state.inside
        live = np.zeros(len(self._scene), dtype=np.bool_)
        live[view.ids] = True
        nodes = self._nodes
        ids = nodes[inside[nodes] & live[self._root[nodes]]]
        above = self._above[ids]
        # What is culled is not drawn, so that its children stand below what it stands below.
        while (culled := (above >= 0) & ~inside[above]).any():
            above = np.where(culled, self._above[above], above)
        row = np.full(len(self._scene), -1, dtype=np.int64)
        row[ids] = np.arange(len(ids))
        return view.at(ids), np.where(above >= 0, row[above], -1)

    def _last_level(self, seen: View) -> IntArray:
        return self._scene.types.levels.level_count[seen.type_index] - 1

    def _level(self, seen: View) -> IntArray:
        """Return the level of each column, coarsest first; short chains repeat theirs, (m, L)."""
        last = self._last_level(seen)
        return np.minimum(np.arange(int(last.max(initial=0)) + 1)[::-1], last[:, None])

    def _layers(self, ids: IntArray) -> IntArray:
        depth = self._depth[ids]
        starts = np.flatnonzero(np.diff(depth, prepend=-1))
        return np.append(starts, len(ids))

    def _area(self, seen: View, above: IntArray, layers: IntArray, whole: BoolArray) -> FloatArray:
        """Return what each node stands for: its own area, or the sum of what is below it, (m,)."""
        own = np.where(whole, seen.area_px * self._scene.importance[seen.ids], 0.0)
        total = own.copy()
        for start, stop in zip(layers[-2::-1].tolist(), layers[:0:-1].tolist(), strict=True):
            rows = slice(start, stop)
            below = above[rows] >= 0
            total += np.bincount(above[rows][below], total[rows][below], minlength=len(total))
        return np.where(whole, own, total)


def _steps(values: FloatArray, above: IntArray, gives_way: FloatArray) -> FloatArray:
    """Return what each step adds to a sum over the front: levels, then children for the node."""
    below = above >= 0
    children = np.bincount(above[below], values[below, 0], minlength=len(values))
    return np.column_stack((np.diff(values, axis=1), children - gives_way * values[:, -1]))
