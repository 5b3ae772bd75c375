"""Levels that objects of one type extract, hold and borrow (LODManager, section 4.1)."""

import numpy as np

from ....base.arrays import BoolArray, FloatArray, IntArray


class SharedLevels:
    """Level that each of N nodes has extracted, whose level it shows, and who holds each slot.

    Slots of all types stand in one array; a slot's holder is a node whose own level lies in it.

    Attributes
    ----------
    slot : (N,) int32
        Slot of the level that each node extracted last; -1 before the first.
    lod, detail : (N,) float64
        Level-of-detail factor in [0, 1] of that level, and what a selection calls it.
    source : (N,) int32
        Node whose level each node shows: itself, one it borrows from, or -1.
    holder : (slots,) int32
        Node that holds each slot, or -1.
    """

    def __init__(self, nodes: int, slots: int) -> None:
        self.slot = np.full(nodes, -1, dtype=np.int32)
        self.lod = np.zeros(nodes)
        self.detail = np.zeros(nodes)
        self.source = np.full(nodes, -1, dtype=np.int32)
        self.holder = np.full(slots, -1, dtype=np.int32)

    def shown(self, node: IntArray) -> tuple[IntArray, FloatArray]:
        """Return slot and factor of the level that nodes show, (m,); slot -1 and 0 for none."""
        source = self.source[node]
        none = source < 0
        slot, lod = self.slot[source], self.lod[source]
        slot[none], lod[none] = -1, 0.0
        return slot, lod

    def extract(self, node: IntArray, slot: IntArray, lod: FloatArray, detail: FloatArray) -> None:
        """Let distinct nodes show levels of their own."""
        self.slot[node], self.lod[node], self.detail[node] = slot, lod, detail
        self.source[node] = node

    def visit(
        self,
        node: IntArray,
        wanted: IntArray,
        lod: FloatArray,
        detail: FloatArray,
        may_extract: BoolArray,
    ) -> None:
        """Visit distinct nodes in the given order, each by the rules of algorithm 4.1.

        A node that shows a level of its wanted slot stays as it is.  Any other borrows the level of
        that slot's holder, and gives up the slot that it held itself; if nobody holds the slot it
        extracts a level and is the holder.  (A holder that extracts for another slot leaves its
        old one at once; the paper leaves a pointer there and finds it false when it compares.)
        When a level is extracted anew, those who borrow it show the new one, and find it wrong at
        their next turn.  A node that may not extract only borrows, and never if it holds a slot.

        Who extracts depends on who has extracted before, so the set of those is found by repeated
        substitution: each pass is right up to one more of them, and a slot gets at most one.
        """
        turns = np.arange(len(node))
        turn = np.full(len(self.slot), len(node))
        turn[node] = turns
        leaves = self._leaves(turn, wanted, may_extract)
        open_to = may_extract & (turns > leaves[wanted])
        extracting = np.empty(0, dtype=np.intp)
        while True:
            moves = self._at_turn(node, turn, wanted, extracting) != wanted
            moves &= may_extract | (self.source[node] != node)
            able = np.flatnonzero(moves & open_to)
            first = np.full(len(self.holder), len(node))
            np.minimum.at(first, wanted[able], able)
            owners = np.sort(first[first < len(node)])
            if np.array_equal(owners, extracting):
                break
            extracting = owners
        mover = node[moves & may_extract]
        moves[extracting] = False
        borrowing = np.flatnonzero(moves)
        source = self._source_at_turn(node, wanted, borrowing, leaves, first)
        self._leave(mover)
        self.extract(node[extracting], wanted[extracting], lod[extracting], detail[extracting])
        self.holder[wanted[extracting]] = node[extracting]
        found_one = source >= 0
        self.source[node[borrowing[found_one]]] = source[found_one]

    def _leaves(self, turn: IntArray, wanted: IntArray, may_extract: BoolArray) -> IntArray:
        """Return the turn at which each slot loses its holder, (slots,).

        -1 where it has none, the number of turns where it keeps it.
        """
        never = len(wanted)
        leaves = np.where(self.holder < 0, -1, never)
        slot = np.flatnonzero(self.holder >= 0)
        at = turn[self.holder[slot]]
        slot, at = slot[at < never], at[at < never]
        goes = may_extract[at] & (wanted[at] != slot)
        leaves[slot[goes]] = at[goes]
        return leaves

    def _at_turn(
        self, node: IntArray, turn: IntArray, wanted: IntArray, extracting: IntArray
    ) -> IntArray:
        """Return the slot whose level each node shows when its turn comes, (m,)."""
        slot, _ = self.shown(node)
        extracts = np.zeros(len(node) + 1, dtype=np.bool_)  # the last stands for nodes not visited
        extracts[extracting] = True
        source = self.source[node]
        before = turn[source]
        changed = np.flatnonzero((source >= 0) & (before < np.arange(len(node))) & extracts[before])
        slot[changed] = wanted[before[changed]]
        return slot

    def _source_at_turn(
        self,
        node: IntArray,
        wanted: IntArray,
        borrowing: IntArray,
        leaves: IntArray,
        first: IntArray,
    ) -> IntArray:
        """Return whose level each borrower finds in its slot at its turn, -1 for nobody's."""
        slot = wanted[borrowing]
        newly = first[slot]
        source = np.full(len(borrowing), -1, dtype=np.int32)
        come = newly < borrowing
        source[come] = node[newly[come]]
        still = borrowing < leaves[slot]
        source[still] = self.holder[slot[still]]
        return source

    def _leave(self, node: IntArray) -> None:
        """Empty the slots that these nodes hold."""
        slot = self.slot[node]
        holds = (slot >= 0) & (self.holder[slot] == node)
        self.holder[slot[holds]] = -1
