"""A list of nodes by falling priority that is kept from frame to frame.

The HLOD thesis (section 4.3) argues for a sorted list instead of a heap, because priorities change
little between frames: a node moves a few places, and new nodes belong near the end.  Here the old
order, new nodes behind it, is sorted again by a merge sort that looks for runs already in order
(numpy's stable sort), and what is counted is what the thesis' linked list would do: one comparison
for each node, and one for each place that a node moved.
"""

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray


class PriorityList:
    """Nodes by falling priority.

    Attributes
    ----------
    ids : (m,) int32
        Distinct nodes, the most important first; equal ones keep their order.
    comparisons : int
        Of the last update.
    """

    def __init__(self) -> None:
        self.ids: IntArray = np.empty(0, dtype=np.int32)
        self.comparisons = 0

    def update(self, listed: BoolArray, priority: FloatArray) -> None:
        """Take the nodes that are to be listed, (N,), and the priorities of all, (N,)."""
        stay = self.ids[listed[self.ids]]
        new = listed.copy()
        new[stay] = False
        before = np.concatenate((stay, np.flatnonzero(new))).astype(np.int32)
        order = np.argsort(-priority[before], kind="stable")
        self.ids = before[order]
        # Half the places moved in all is at most the number of exchanges of neighbours, and all of
        # it at least (Diaconis and Graham, 1977): the count is never below an insertion sort's.
        moved = int(np.abs(order - np.arange(len(order))).sum())
        self.comparisons = len(before) + moved
