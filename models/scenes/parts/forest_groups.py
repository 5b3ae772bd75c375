"""Trees in groups: a quadtree that is divided until no cell holds more than 64 of them."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray, IntArray

MOST_IN_GROUP = 64
"""Zach, Mantler and Karner, section 4."""

_CROWN_M = 12.0  # how far a tree reaches above its place
_DEEPEST = 20


@dataclass(frozen=True, slots=True)
class TreeGroups:
    """N nodes, parents first; leaves are groups.

    Attributes
    ----------
    parent : (N,) int
    trees : (N,) int
        Of a group; 0 above.
    center_m, radius_m : (N, 3), (N,) float64
        Spheres about all trees at or below each node.
    """

    parent: IntArray
    trees: IntArray
    center_m: FloatArray
    radius_m: FloatArray


def group_trees(position_m: FloatArray, width_m: float) -> TreeGroups:
    """Return the groups of trees at (n, 3) positions in a square with a corner at the origin."""
    rows = np.arange(len(position_m))  # trees, by cell
    start, node = np.array([0]), np.array([0])
    parents, counts = [np.array([-1])], [np.zeros(1, dtype=np.int64)]
    low, high = [position_m.min(axis=0)[None]], [position_m.max(axis=0)[None]]
    first = 1
    for depth in range(1, _DEEPEST):
        size = np.diff(np.append(start, len(rows)))
        counts[-1][node] = np.where(size <= MOST_IN_GROUP, size, 0)
        split = size > MOST_IN_GROUP
        if not split.any():
            break
        rows = rows[np.repeat(split, size)]
        owner = np.repeat(first - len(counts[-1]) + node[split], size[split])
        cell = np.floor(position_m[rows, :2] * (2.0**depth / width_m)).astype(np.int64)
        key = 4 * owner + 2 * (cell[:, 1] & 1) + (cell[:, 0] & 1)
        order = np.argsort(key, kind="stable")
        rows, key = rows[order], key[order]
        start = np.flatnonzero(np.diff(key, prepend=-1))
        node = np.arange(len(start))
        parents.append(key[start] // 4)
        counts.append(np.zeros(len(start), dtype=np.int64))
        low.append(np.minimum.reduceat(position_m[rows], start))
        high.append(np.maximum.reduceat(position_m[rows], start))
        first += len(start)
    bottom, top = np.concatenate(low), np.concatenate(high)
    top[:, 2] += _CROWN_M
    return TreeGroups(
        np.concatenate(parents),
        np.concatenate(counts),
        (bottom + top) / 2.0,
        np.linalg.norm(top - bottom, axis=1) / 2.0 + 1.0,
    )
