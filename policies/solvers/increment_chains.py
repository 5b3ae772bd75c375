"""Increments of rows that stand by themselves, sorted no further than the budget asks for."""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .column_counts import count_true
from .falling_cut import FallingCut
from .increment_forest import IncrementForest


class IncrementChains(IncrementForest):
    """An `IncrementForest` without layers, whose first portion is cut instead of sorted."""

    def __init__(self, cost: FloatArray, ratio: FloatArray, cut: FallingCut) -> None:
        """Take costs, positive, and the least benefit per cost met on the way to each, (m, W).

        A ratio that is not positive says that there is no such increment, nor one behind it; none
        is infinite.  `cut` is kept from frame to frame.
        """
        self._all_cost, self._ratio, self._cut = cost.ravel(), ratio.ravel(), cut
        self.taken = np.zeros(cost.shape, dtype=np.bool_)
        self.count = int(np.count_nonzero(ratio > 0.0))
        self._untouched = self.count > 0
        self._follow(np.zeros(0, dtype=np.intp))

    def slope(self, left: float) -> float:
        """Return benefit per cost of the best increment that costs at most `left`; 0 if none."""
        if self._untouched:
            best = int(self._ratio.argmax())
            if self._all_cost[best] <= left:
                return float(self._ratio[best])
            self._sort()
        return super().slope(left)

    def take(self, slope: float, left: float) -> float:
        """Take increments in order down to `slope` while they fit; return what they cost."""
        if not self._untouched or slope > 0.0:
            self._sort()
            return super().take(slope, left)
        taken, spent, first_left = self._cut.take(self._ratio, self._all_cost, left)
        self._untouched = False
        self.taken = taken.reshape(self.taken.shape)
        if first_left >= 0:
            self._follow(self._still_possible(left - spent))
        return spent

    def ahead(self, left: float) -> tuple[float, float]:
        """Return a slope to which smooth variables may be raised, and what that may cost."""
        self._sort()
        return super().ahead(left)

    def _still_possible(self, left: float) -> IntArray:
        """Return increments that fit and have none before them in their rows that does not."""
        fits = self._all_cost <= left
        fits &= self._ratio > 0.0
        fits &= ~self.taken.ravel()
        at = fits.nonzero()[0]
        row, place = np.divmod(at, self.taken.shape[1])
        # Those of a row stand together: as many as stand before one are to be between it and the
        # last one taken.
        begins = np.flatnonzero(np.diff(row, prepend=-1))
        before = np.arange(len(at)) - np.repeat(begins, np.diff(begins, append=len(at)))
        done = count_true(np.ascontiguousarray(self.taken.T))
        return at[place - done[row] == before]

    def _sort(self) -> None:
        if self._untouched:
            self._untouched = False
            self._follow(np.flatnonzero(self._ratio > 0.0))

    def _follow(self, at: IntArray) -> None:
        """Go on with these increments, in order."""
        key = self._ratio[at]
        # Stable: of equal keys the one above stands first.
        order = np.argsort(-key, kind="stable")
        self._rest, self._key = at[order], key[order]
        self._cost = self._all_cost[self._rest]

    def _drop(self, left: float) -> None:
        """Drop increments that do not fit any more, and those behind them in their rows."""
        row = self._rest // self.taken.shape[1]
        misfit = (self._cost > left).nonzero()[0]
        first = np.full(len(self.taken), len(row))
        np.minimum.at(first, row[misfit], misfit)
        self._keep(np.flatnonzero(np.arange(len(row)) < first[row]))
