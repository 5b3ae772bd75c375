"""Increments of rows that stand by themselves, sorted no further than the budget asks for."""

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .falling_cut import FallingCut
from .increment_forest import IncrementForest


class IncrementChains(IncrementForest):
    """An `IncrementForest` without layers, whose first portion is cut instead of sorted."""

    def __init__(self, cost: FloatArray, ratio: FloatArray, cut: FallingCut) -> None:
        """Take costs, positive, and the least benefit per cost met on the way to each, (m, W).

        A ratio that is not positive says that there is no such increment; none is infinite.  `cut`
        is kept from frame to frame.
        """
        self._above, self._layers = np.full(len(cost), -1), np.array([0, len(cost)])
        self._matrix, self._ratio, self._cut = cost, ratio, cut
        self.taken = np.zeros(cost.shape, dtype=np.bool_)
        self.count = int(np.count_nonzero(ratio > 0.0))
        self._untouched = self.count > 0
        self._rest = np.zeros(0, dtype=np.intp)
        self._key = self._cost = np.zeros(0)

    def slope(self, left: float) -> float:
        """Return benefit per cost of the best increment that costs at most `left`; 0 if none."""
        if self._untouched:
            best = int(self._ratio.argmax())
            if self._matrix.ravel()[best] <= left:
                return float(self._ratio.ravel()[best])
            self._sort()
        return super().slope(left)

    def take(self, slope: float, left: float) -> float:
        """Take increments in order down to `slope` while they fit; return what they cost."""
        if not self._untouched or slope > 0.0:
            self._sort()
            return super().take(slope, left)
        taken, spent, first_left = self._cut.take(self._ratio.ravel(), self._matrix.ravel(), left)
        self._untouched = False
        self.taken = taken.reshape(self._matrix.shape)
        if first_left >= 0:
            # Few are left that still fit, and stand behind none that does not.
            dead = (self._matrix > left - spent) & ~self.taken
            np.logical_or.accumulate(dead, axis=1, out=dead)
            self._follow(~(dead | self.taken).ravel() & (self._ratio.ravel() > 0.0))
        return spent

    def ahead(self, left: float) -> tuple[float, float]:
        """Return a slope to which smooth variables may be raised, and what that may cost."""
        self._sort()
        return super().ahead(left)

    def _sort(self) -> None:
        if self._untouched:
            self._untouched = False
            self._follow(self._ratio.ravel() > 0.0)

    def _follow(self, which: BoolArray) -> None:
        """Go on with these increments, in order."""
        at = which.nonzero()[0]
        key = self._ratio.ravel()[at]
        order = np.argsort(-key, kind="stable")
        self._rest, self._key = at[order], key[order]
        self._cost = self._matrix.ravel()[self._rest]
