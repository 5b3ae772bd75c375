"""The structure of a scene's hierarchy: depth, leaves, and what a front covers."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, IntArray, derive
from .benefit import level_primitives
from .scene import Scene


@dataclass(frozen=True, slots=True)
class Tree:
    """Derived from a scene, once a replay.

    A unit is what full detail consists of: a leaf, or a node with geometry that stays drawn when
    its children are (3D Tiles' ADD).

    Attributes
    ----------
    scene : Scene
    depth : (N,) int32, 0 for roots
    leaf : (N,) bool
    primitives : (N,) float64
        Triangles and splats of each node at its finest level.
    leaf_primitives : (N,) float64
        Sum of `primitives` over the leaves at or below each node.
    units : (U,) int
        Units in ascending order.
    """

    scene: Scene
    depth: IntArray = field(init=False)
    leaf: BoolArray = field(init=False)
    primitives: FloatArray = field(init=False)
    leaf_primitives: FloatArray = field(init=False)
    units: IntArray = field(init=False)
    _layers: list[NDArray[np.intp]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        scene = self.scene
        levels = scene.types.levels
        depth = np.zeros(len(scene), dtype=np.int32)
        above = scene.parent.copy()
        while (below := above >= 0).any():
            depth[below] += 1
            above[below] = scene.parent[above[below]]
        layers = [np.flatnonzero(depth == d) for d in range(1, int(depth.max()) + 1)]
        leaf = np.diff(scene.child_start) == 0
        primitives = level_primitives(levels)[levels.start[:-1]][scene.type_index]
        total = np.where(leaf, primitives, 0.0)
        for layer in reversed(layers):
            np.add.at(total, scene.parent[layer], total[layer])
        units = np.flatnonzero(leaf | (scene.additive & (primitives > 0)))
        derive(self, depth=depth, leaf=leaf, units=units, _layers=layers)
        derive(self, primitives=primitives, leaf_primitives=total)

    def cover(self, ids: IntArray) -> IntArray:
        """Return, for every node, the drawn node that stands for it, or -1, (N,) int32.

        A node without geometry stands for nothing but itself, and a node that stays drawn beside
        its children does not stand for them.
        """
        scene = self.scene
        cover = np.full(len(scene), -1, dtype=np.int32)
        solid = ids[(self.primitives[ids] > 0) | self.leaf[ids]]
        cover[solid] = solid
        for layer in self._layers:
            parent = scene.parent[layer]
            above = cover[parent]
            above[scene.additive[parent] & (above == parent)] = -1
            mine = cover[layer]
            cover[layer] = np.where(mine >= 0, mine, above)
        return cover

    def drawn_twice(self, ids: IntArray) -> int:
        """Return a node of `ids` that is drawn below another one which replaces it, or -1."""
        scene = self.scene
        replaces = np.zeros(len(scene), dtype=np.bool_)
        replaces[ids] = ~scene.additive[ids]
        above = scene.parent[ids]
        while (below := above >= 0).any():
            twice = below & replaces[above]
            if twice.any():
                return int(ids[twice.argmax()])
            above = np.where(below, scene.parent[above], -1)
        return -1

    def first_in(self, member: BoolArray, ids: IntArray) -> IntArray:
        """Return each node's nearest strict ancestor that is a member, or -1, (m,)."""
        parent = self.scene.parent
        above = parent[ids].copy()
        while (going := (above >= 0) & ~member[above]).any():
            above[going] = parent[above[going]]
        return above


def relative_depth(scene: Scene) -> FloatArray:
    """Return how deep nodes are in the tree, (N,): 0 for roots to 1; of a flat scene all are 0."""
    if scene.flat:
        return np.zeros(len(scene))
    depth = Tree(scene).depth
    return depth / max(1, int(depth.max()))
