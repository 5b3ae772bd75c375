"""The discrete half of a mixed scene: representations, and the increments of one frame."""

from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...models.machine.frame_cost import FrameCost
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree
from ..solvers.increment_forest import IncrementForest
from ..view import View


@dataclass(frozen=True, slots=True)
class Offer:
    """Discrete nodes in view, one a row, and the increments that refine them.

    Attributes
    ----------
    view : View
        Of the m nodes, by depth.
    above : (m,) int
        Row of the nearest node above that is in view, -1 for none.
    base_ms, base_benefit : float
        Sums over the coarsest front.
    forest : IncrementForest
        Columns of a row: one level finer, and so on; last, the children in place of the node.
    """

    view: View
    above: IntArray
    base_ms: float
    base_benefit: float
    forest: IncrementForest


@dataclass(frozen=True, slots=True)
class Patches:
    """Nodes whose representations are discrete, derived from a scene once a replay.

    A node has its levels, coarsest first, then its children instead of itself (or beside itself,
    where it stays drawn).  Benefit of a representation is ``sqrt(2^(d_max - d)) · S``, d its height
    in such steps above the finest one below it, d_max that of the tree.  S is the area in view, the
    sum over the leaves in view, so that a node half out of view does not count in full.
    """

    scene: Scene
    tree: Tree
    costs: FrameCost
    member: BoolArray
    _nodes: IntArray = field(init=False)
    _above: IntArray = field(init=False)
    _depth: IntArray = field(init=False)
    _exponent: FloatArray = field(init=False)
    _root: IntArray = field(init=False)

    def __post_init__(self) -> None:
        scene, depth = self.scene, self.tree.depth
        n, put = len(scene), object.__setattr__
        layers = [np.flatnonzero(depth == d) for d in range(int(depth.max()) + 1)]
        above = self.tree.first_in(self.member, np.arange(n))
        root, steps = np.arange(n), np.zeros(n, dtype=np.int64)
        for layer in layers[1:]:
            root[layer] = root[scene.parent[layer]]
            has = layer[above[layer] >= 0]
            steps[has] = steps[above[has]] + 1
        height = np.zeros(n, dtype=np.int64)
        coarser = scene.level_count - 1
        for layer in layers[:0:-1]:
            has = layer[self.member[layer] & (above[layer] >= 0)]
            np.maximum.at(height, above[has], height[has] + coarser[has] + 1)
        highest = np.zeros(n, dtype=np.int64)
        nodes = np.flatnonzero(self.member)
        np.maximum.at(highest, root[nodes], height[nodes] + coarser[nodes])
        put(self, "_nodes", nodes[np.argsort(steps[nodes], kind="stable")].astype(np.int32))
        put(self, "_above", above)
        put(self, "_depth", steps)
        put(self, "_exponent", (highest[root] - height).astype(np.float64))
        put(self, "_root", root)

    def offer(self, view: View) -> Offer:
        """Return the discrete nodes in view below the view's roots."""
        seen, above = self._in_view(view)
        level = self._level(seen)
        row = self.scene.types.levels.start[seen.type_index][:, None] + level
        cost_ms = self.costs.objects_ms(row, seen)
        has_children = np.bincount(above[above >= 0], minlength=len(above)) > 0
        stays = self.scene.additive[seen.ids]
        layers = self._layers(seen.ids)
        area = self._area(seen, above, layers, whole=stays | ~has_children)
        exponent = self._exponent[seen.ids][:, None]
        benefit = np.exp2(0.5 * (exponent - level)) * area[:, None]
        void = np.column_stack((level[:, 1:] == level[:, :-1], ~has_children))
        gives_way = np.where(stays, 0.0, 1.0)
        forest = IncrementForest(
            _steps(cost_ms, above, gives_way),
            _steps(benefit, above, gives_way),
            void,
            above,
            layers,
        )
        top = above < 0
        base = float(cost_ms[top, 0].sum()), float(benefit[top, 0].sum())
        return Offer(seen, above, *base, forest)

    def front(self, offer: Offer) -> tuple[IntArray, FloatArray]:
        """Return ids and detail of what is drawn after the increments that were taken."""
        seen, taken = offer.view, offer.forest.taken
        refined = taken[:, -1]
        reached = np.where(offer.above >= 0, refined[offer.above], np.True_)
        drawn = reached & (~refined | self.scene.additive[seen.ids])
        level = self._last_level(seen) - taken[:, :-1].sum(axis=1)
        levels, kind = self.scene.types.levels, seen.type_index
        knot = levels.resolution[levels.start[kind] + level.astype(np.int64)]
        detail = np.where(levels.continuous[kind], knot, level)
        return seen.ids[drawn], detail[drawn]

    def _in_view(self, view: View) -> tuple[View, IntArray]:
        """Return the nodes in view, by depth, and the row of the nearest one above each."""
        inside = view.state.inside
        live = np.zeros(len(self.scene), dtype=np.bool_)
        live[view.ids] = True
        nodes = self._nodes
        ids = nodes[inside[nodes] & live[self._root[nodes]]]
        above = self._above[ids]
        # What is culled is not drawn, so that its children stand below what it stands below.
        while (culled := (above >= 0) & ~inside[above]).any():
            above = np.where(culled, self._above[above], above)
        row = np.full(len(self.scene), -1, dtype=np.int64)
        row[ids] = np.arange(len(ids))
        return view.at(ids), np.where(above >= 0, row[above], -1)

    def _last_level(self, seen: View) -> IntArray:
        return self.scene.types.levels.level_count[seen.type_index] - 1

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
        own = np.where(whole, seen.area_px * self.scene.importance[seen.ids], 0.0)
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
