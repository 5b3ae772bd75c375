"""The greedy cut: items by falling key while they fit a budget, mostly without sorting them.

Between frames the key at which the budget is used up moves little.  So what stands well above its
last place is taken by one comparison, and only what is near it is sorted.
"""

from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray

_NEAR = 1.05  # factor about the last place within which the cut is looked for first
_FAR = 4.0  # factor by which it is looked for further away


class Cut(NamedTuple):
    """Items that fit.

    Attributes
    ----------
    taken : (k,) bool
    spent : float
        What they cost.
    first_left : int
        The first item that does not fit; -1 if everything does.
    """

    taken: BoolArray
    spent: float
    first_left: int


class FallingCut:
    """Cuts one set of items after another, each near the key at which the last one was cut."""

    def __init__(self) -> None:
        self._key = 0.0
        self._fitted = True

    def take(self, key: FloatArray, cost: FloatArray, budget: float) -> Cut:
        """Return the items of positive key, (k,), by falling key up to the first that does not fit.

        Of equal keys the one that stands first in the arrays goes first.  Neither costs nor the
        budget are negative.
        """
        asked = self._fitted
        if asked and (everything := _above(0.0, key, cost)).spent <= budget:
            return everything
        high = _NEAR * (self._key or float(key.max()))
        low = high / _NEAR**2
        above = _above(high, key, cost)
        while above.spent > budget:
            low, high = high, _FAR * high
            above = _above(high, key, cost)
        more = _above(low, key, cost)
        if more.spent <= budget and not asked:
            self._fitted = (everything := _above(0.0, key, cost)).spent <= budget
            if self._fitted:
                return everything
        while more.spent <= budget:
            above, low = more, low / _FAR
            more = _above(low, key, cost)
        return self._between(above, more, key, cost, budget)

    def _between(
        self, above: Cut, more: Cut, key: FloatArray, cost: FloatArray, budget: float
    ) -> Cut:
        """Return the cut, where what is above fits and more does not."""
        at = (above.taken ^ more.taken).nonzero()[0]
        at = at[np.argsort(-key[at], kind="stable")]
        total = np.cumsum(cost[at])
        total += above.spent
        # `right`, because a sum that equals what is left still fits.  Not everything does, even
        # where sums in this order say so by their last bits.
        count = min(int(np.searchsorted(total, budget, side="right")), len(at) - 1)
        above.taken[at[:count]] = True
        spent = float(total[count - 1]) if count else above.spent
        self._key, self._fitted = float(key[at[count]]), False
        return Cut(above.taken, spent, int(at[count]))


def _above(least: float, key: FloatArray, cost: FloatArray) -> Cut:
    taken = key > least
    return Cut(taken, float((cost * taken).sum()), -1)
