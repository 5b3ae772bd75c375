"""Increments of rows that stand by themselves, sorted no further than the budget asks for."""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .column_counts import count_true
from .falling_cut import FallingCut
from .falling_prefix import falling_prefix
from .increment_forest import IncrementForest


class IncrementChains(IncrementForest):
    """An `IncrementForest` without layers, for where nothing else is raised in turn with it."""

    def __init__(self, cost: FloatArray, ratio: FloatArray, cut: FallingCut) -> None:
        """Take costs, positive, and the least benefit per cost met on the way to each, (m, W).

        A ratio that is not positive says that there is no such increment, nor one behind it; none
        is infinite.  `cut` is kept from frame to frame.
        """
        self._all_cost, self._ratio, self._cut = cost.ravel(), ratio.ravel(), cut
        self._rows, self._width = len(cost), cost.shape[1]
        self.taken = np.zeros((self._rows, self._width), dtype=np.bool_)
        self.count = int(np.count_nonzero(ratio > 0.0))
        # What is left, not in order but by its place in the arrays; all of it at first.
        self._rest = np.zeros(0, dtype=np.intp)
        self._key, self._cost = self._ratio, self._all_cost
        self._untouched, self._sorted = True, False

    def slope(self, left: float) -> float:
        """Return benefit per cost of the best increment that costs at most `left`; 0 if none."""
        if self._sorted:
            return super().slope(left)
        best = int(self._key.argmax()) if len(self._key) else -1
        if best >= 0 and self._key[best] > 0.0 and self._cost[best] > left:
            self._keep_possible(left)
            best = int(self._key.argmax()) if len(self._key) else -1
        return max(float(self._key[best]), 0.0) if best >= 0 else 0.0

    def take(self, slope: float, left: float) -> float:
        """Take increments in order down to `slope` while they fit; return what they cost."""
        if slope > 0.0 or self._sorted:
            self._sort()
            return super().take(slope, left)
        if self._untouched:
            taken, spent, _ = self._cut.take(self._ratio, self._all_cost, left)
            self.taken = taken.reshape(self._rows, self._width)
        else:
            order, total = falling_prefix(self._key, self._cost, left)
            count = int(np.searchsorted(total, left, side="right"))
            self.taken.ravel()[self._rest[order[:count]]] = True
            spent = float(total[count - 1]) if count else 0.0
        # Of what is left only that counts which still fits.
        self._keep_possible(left - spent)
        return spent

    def ahead(self, left: float) -> tuple[float, float]:
        """Return a slope to which smooth variables may be raised, and what that may cost."""
        self._sort()
        return super().ahead(left)

    def _keep_possible(self, left: float) -> None:
        """Keep increments that fit and have none before them in their rows that does not."""
        self._untouched = False
        at = (self._all_cost <= left).nonzero()[0]
        open_to = self._ratio.take(at) > 0.0
        open_to &= ~self.taken.ravel().take(at)
        at = at[open_to]
        # By one divisor, which numpy has a fast way for, unlike `divmod`.
        row: IntArray = at // self._width
        place = at - row * self._width
        # Those of a row stand together: as many as stand before one are to be between it and the
        # last one taken.
        index = np.arange(len(at))
        begins = np.zeros(len(at), dtype=np.intp)
        begins[1:] = index[1:] * (row[1:] != row[:-1])
        before = index - np.maximum.accumulate(begins)
        done = self.taken.take(row, axis=0)
        before += count_true(np.ascontiguousarray(done.T))
        self._rest = at[place == before]
        self._key, self._cost = self._ratio.take(self._rest), self._all_cost.take(self._rest)

    def _sort(self) -> None:
        """Put what is left in order, as `IncrementForest` has it."""
        if self._untouched:
            self._keep_possible(np.inf)
        if not self._sorted:
            self._sorted = True
            order = np.argsort(-self._key, kind="stable")
            self._keep(order)

    def _drop(self, left: float) -> None:
        """Drop increments that do not fit any more, and those behind them in their rows."""
        row = self._rest // self._width
        misfit = (self._cost > left).nonzero()[0]
        first = np.full(self._rows, len(row))
        np.minimum.at(first, row[misfit], misfit)
        self._keep(np.flatnonzero(np.arange(len(row)) < first[row]))
