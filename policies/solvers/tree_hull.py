"""Increments on the upper hull of a hierarchy: which refinements are worth taking together.

Refining a node costs and brings something, and makes its children refinable.  If a child's
refinement pays more per cost than its parent's, no optimum of the relaxed problem takes the parent
alone, and the two are one increment.  Merging so from the deepest nodes up until no increment is
steeper than the one above it yields increments that may be taken by falling slope: each prefix is
an optimum of the relaxation at its own cost (isotonic regression on a rooted tree; Horn, "Single-
machine job sequencing with treelike precedence ordering", SIAM J. Appl. Math. 23, 1972).
"""

from collections import defaultdict
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ..shared.trees.hierarchy import Hierarchy


@dataclass(frozen=True, slots=True)
class TreeIncrements:
    """k increments by falling slope, an increment behind those above it.

    Attributes
    ----------
    cost, benefit : (k,) float64
    slope : (k,) float64
        Infinite where nothing is paid for the benefit.
    owner : (N,) int
        Position of each node's increment, -1 of nodes that are not to be refined.
    """

    cost: FloatArray
    benefit: FloatArray
    slope: FloatArray
    owner: IntArray


def tree_increments(
    hierarchy: Hierarchy, cost: FloatArray, benefit: FloatArray, item: BoolArray
) -> TreeIncrements:
    """Merge the refinements of the nodes marked in `item` into increments.

    `cost` and `benefit` are (N,), of refining each node; an item's nearest ancestor that is no item
    but empty is passed over, any other ancestor must be an item.
    """
    depth = hierarchy.tree.depth
    up = next_above(hierarchy, item)
    cost, benefit = np.where(item, cost, 0.0), np.where(item, benefit, 0.0)
    head, block = item.copy(), np.arange(len(cost))
    slope = _slopes(cost, benefit)
    # From the deepest layer up: what hangs below a layer is merged for good when it is its turn.
    for at in range(len(hierarchy.layers) - 1, -1, -1):
        while True:
            steep = np.flatnonzero(head & (up >= 0))
            steep = steep[(depth[up[steep]] == at) & (slope[steep] > slope[up[steep]])]
            if not len(steep):
                break
            # Only the steepest child of each parent: once it has joined, the parent's slope is
            # another, and the other children have to be compared with that.
            steep = steep[np.lexsort((-slope[steep], up[steep]))]
            steep = steep[np.concatenate(([True], np.diff(up[steep]) > 0))]
            onto = up[steep]
            cost[onto] += cost[steep]
            benefit[onto] += benefit[steep]
            slope[onto] = _slopes(cost[onto], benefit[onto])
            head[steep] = False
            block[steep] = onto
            # Children of what was merged hang on the block that it joined.
            up = np.where(up >= 0, block[up], -1)
    # A block may have joined one that joined another later: follow to the end.
    while (block[block] != block).any():
        block = block[block]
    heads = np.flatnonzero(head)
    # Of equal slopes the upper first: an increment must not come before one above it.
    heads = heads[np.lexsort((depth[heads], -slope[heads]))]
    position = np.full(len(head), -1)
    position[heads] = np.arange(len(heads))
    owner = np.where(item, position[block], -1)
    return TreeIncrements(cost[heads], benefit[heads], slope[heads], owner)


def next_above(hierarchy: Hierarchy, item: BoolArray) -> IntArray:
    """Return each node's parent, empty nodes passed over; -1 if there is none, (N,)."""
    up = hierarchy.scene.parent.astype(np.intp)
    while (passed := (up >= 0) & hierarchy.empty[up] & ~item[up]).any():
        up[passed] = hierarchy.scene.parent[up[passed]]
    return up


def _slopes(cost: FloatArray, benefit: FloatArray) -> FloatArray:
    # At no cost: first of all where nothing is lost, never otherwise.
    free = np.where(benefit >= 0.0, np.inf, -np.inf)
    return np.divide(benefit, cost, out=free, where=cost > 0.0)


def take_part(
    up: IntArray, members: IntArray, cost: FloatArray, benefit: FloatArray, room: float
) -> tuple[list[int], float]:
    """Return nodes of an increment that does not fit as a whole, and what they bring.

    Its `members` are taken by falling slope, each behind the one above it, passing over those that
    do not fit; of what was taken so the prefix that brings most is returned.  `up` is the result
    of `next_above`.
    """
    inner = set(members.tolist())
    below: defaultdict[int, list[int]] = defaultdict(list)
    for node in members.tolist():
        below[int(up[node]) if int(up[node]) in inner else -1].append(node)
    slope = _slopes(cost, benefit)
    heap = [(-float(slope[node]), node) for node in below[-1]]
    heapify(heap)
    taken: list[int] = []
    gain, best, count = 0.0, 0.0, 0
    while heap:
        _, node = heappop(heap)
        if cost[node] > room:
            continue
        room -= float(cost[node])
        gain += float(benefit[node])
        taken.append(node)
        if gain > best:
            best, count = gain, len(taken)
        for child in below[node]:
            heappush(heap, (-float(slope[child]), child))
    return taken[:count], best
