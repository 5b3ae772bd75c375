"""One smooth variable for all leaves below a node of a tree, where that loses little.

This work is based on: Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous
levels of detail", VRST 2002, Algorithm 1 and Appendix A.  n leaves of benefit ``Σ c · sqrt(x)``
that share a budget X evenly lose at most ``C sqrt(X) (1 - 1 / sqrt(n))``, ``C = Σ c``; a node gets
one variable where this is less than ``ε / n``, and is split into its children otherwise.

Readings.  The print's ``2^(d_max - d)`` is n.  Its ``k S²`` is C, summed over the leaves.  Its
``X_i = X / Σ S_j^4``, which lacks the numerator ``S_i^4`` of the solution by Lagrange multipliers,
is the sum of the leaves' own shares, ``∝ c²`` within their bounds: with the square of a node's sum
in its place, an uneven node can lose more than its bound.  Leaves of unequal cost at full
resolution share in proportion to it, and ``1 / n`` in the bound is the least cost over the sum.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree


class LeafTree:
    """Some leaves of a scene from left to right, so that those below a node stand together.

    Attributes
    ----------
    leaves : (U,) int
        Node ids in that order.
    first, stop : (N,) int
        Range of places in `leaves` below each node; empty where there is none.
    """

    def __init__(self, scene: Scene, tree: Tree, member: BoolArray) -> None:
        self.scene = scene
        parent, depth = scene.parent, tree.depth
        layers = [np.flatnonzero(depth == d) for d in range(int(depth.max()) + 1)]
        # Leaves below each node, summed from the deepest layer up.
        count = member.astype(np.int64)
        for layer in layers[:0:-1]:
            np.add.at(count, parent[layer], count[layer])
        # A node's leaves begin where its parent's do, behind those of the siblings before it.
        first = np.zeros(len(parent), dtype=np.int64)
        for layer in layers:
            family = layer[np.argsort(parent[layer], kind="stable")]
            before = np.cumsum(count[family]) - count[family]
            # -2 is nobody's parent: the roots, whose parent is -1, begin a family of their own.
            eldest = np.flatnonzero(np.diff(parent[family], prepend=-2))
            start = np.repeat(before[eldest], np.diff(eldest, append=len(family)))
            above = parent[family]
            first[family] = before - start + np.where(above >= 0, first[above], 0)
        leaves = np.flatnonzero(member)
        self.leaves = leaves[np.argsort(first[leaves], kind="stable")].astype(np.int32)
        self.first, self.stop = first, first + count

    def children(self, nodes: IntArray) -> IntArray:
        """Return the children of all nodes, in order."""
        start = self.scene.child_start[nodes]
        count = self.scene.child_start[nodes + 1] - start
        before = np.cumsum(count) - count
        return self.scene.child_ids[np.repeat(start - before, count) + np.arange(int(count.sum()))]


@dataclass(frozen=True, slots=True)
class Splitting:
    """Which leaves share a variable.

    Attributes
    ----------
    start : (V,) int
        First place of each variable among the drawn leaves; it stands for all up to the next.
    loss : float
        Most benefit that sharing may lose, by Appendix A.
    allowed : float
        What ε allowed to lose: the sum of ``ε / n`` over variables of several leaves.
    visited : int
        Nodes visited.
    """

    start: IntArray
    loss: float
    allowed: float
    visited: int


def split_variables(
    tree: LeafTree,
    drawn: BoolArray,
    weight: FloatArray,
    low: FloatArray,
    high: FloatArray,
    share: FloatArray,
    epsilon: float,
) -> Splitting:
    """Return the variables of the drawn leaves.

    Parameters
    ----------
    tree : LeafTree
    drawn : (U,) bool
    weight, low, high, share : (u,) float64
        Of the u drawn leaves: factor of sqrt(x), least and greatest cost x, and the share of the
        budget that is best for them.  A node whose share does not pay for all its leaves at the
        highest of their least resolutions is split.
    epsilon : float
    """
    # Ranges of `tree` count all leaves; these count the drawn ones.
    place = np.concatenate(([0], np.cumsum(drawn)))
    values = np.stack((weight, share, high))
    floor = np.divide(low, high, out=np.ones(len(low)), where=high > 0.0)
    start: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    loss, allowed, visited = 0.0, 0.0, 0
    nodes = tree.scene.roots
    # The recursion of Algorithm 1, all nodes of one depth at a time.
    while True:
        first, stop = place[tree.first[nodes]], place[tree.stop[nodes]]
        some = stop > first
        nodes, first, stop = nodes[some], first[some], stop[some]
        if not len(nodes):
            return Splitting(np.sort(np.concatenate(start)), loss, allowed, visited)
        visited += len(nodes)
        count = stop - first
        lost, payable = _lost(first, stop, values, floor)
        # The printed test, `count` for 2^(d_max - d).  A leaf alone loses nothing by sharing.
        shared = (lost < epsilon / count) & payable & (count > 1)
        start.append(first[shared | (count == 1)])
        loss += float(lost[shared].sum())
        allowed += float((epsilon / count[shared]).sum())
        nodes = tree.children(nodes[~shared & (count > 1)])


def _lost(
    first: IntArray, stop: IntArray, values: FloatArray, floor: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return what leaves in each range may lose by sharing, and whether they can at all.

    `values` are weight, share and greatest cost of leaves, `floor` their least resolution.
    """
    # `reduceat` reduces between neighbours of the list: every second result is of a gap.
    ends = np.stack((first, stop), axis=1).ravel()
    # One place more, because a range may end with the last leaf.
    padded = np.concatenate((values, np.zeros((3, 1))), axis=1)
    weight, spend, full = np.add.reduceat(padded, ends, axis=1)[:, ::2]
    least = np.minimum.reduceat(padded[2], ends)[::2]
    highest = np.maximum.reduceat(np.append(floor, 0.0), ends)[::2]
    # Appendix A's worst case, all weight on one leaf: with equal leaves this part is its 1 / n.
    part = np.divide(least, full, out=np.ones(len(full)), where=full > 0.0)
    # Sums in another order differ in the last bits, which must not split a node that just pays.
    payable = full * highest <= spend * (1.0 + 1e-12)
    return weight * np.sqrt(spend) * (1.0 - np.sqrt(part)), payable
