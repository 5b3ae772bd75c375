"""Refinement from the roots down, the most urgent node first, while it fits."""

from heapq import heapify, heappop, heappush

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ...view import View
from .hierarchy import Hierarchy


def refine_best_first(
    hierarchy: Hierarchy, view: View, key: FloatArray, cost: FloatArray, room: float
) -> tuple[BoolArray, int]:
    """Return which nodes are refined, (N,), and how many were looked at.

    Of the nodes in the frustum whose ancestors are refined, the one of largest positive `key` (of
    equal ones the first) is refined next; the first whose `cost` exceeds what is left of `room`
    ends it.  Empty nodes are refined at no cost of their own: `fold_empty` has charged it above.
    """
    scene = hierarchy.scene
    may = hierarchy.inner & view.state.inside
    key = np.where(hierarchy.empty, np.inf, key)
    may &= key > 0.0
    start, child_ids = scene.child_start, scene.child_ids
    urgency, price, open_to = (-key).tolist(), cost.tolist(), may.tolist()
    heap = [(urgency[node], node) for node in view.ids[may[view.ids]].tolist()]
    heapify(heap)
    refined = np.zeros(len(scene), dtype=np.bool_)
    looked = len(heap)
    while heap:
        _, node = heappop(heap)
        if price[node] > room and not hierarchy.empty[node]:
            break
        room -= price[node]
        refined[node] = True
        for child in child_ids[start[node] : start[node + 1]].tolist():
            if open_to[child]:
                heappush(heap, (urgency[child], child))
                looked += 1
    return refined, looked
