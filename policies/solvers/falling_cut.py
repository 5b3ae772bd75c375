"""The greedy cut: items by falling key while they fit a budget, mostly without sorting them.

Between frames the key at which the budget is used up moves little.  So everything well above its
last place is taken by one comparison, and only what is near it is sorted.
"""

from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray

_SPREAD = 1.05
"""Factor about the last place within which the cut is looked for first."""


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
    """Cuts one set of items after another, each near the place of the cut before."""

    def __init__(self) -> None:
        self._place = 0.0

    def take(self, key: FloatArray, cost: FloatArray, budget: float) -> Cut:
        """Return the items of positive key, (k,), by falling key up to the first that does not fit.

        Of equal keys the one that stands first in the arrays goes first.  Neither costs nor the
        budget are negative.
        """
        # At 0 everything fitted the last time: it is asked at once whether it does again.
        high, low = self._place * _SPREAD, self._place / _SPREAD
        taken = key > high
        spent = float((cost * taken).sum())
        if spent > budget:
            # The cut is higher than it was: below `high` nothing is taken, above not everything.
            parts, taken, spent = [taken], np.zeros(len(key), dtype=np.bool_), 0.0
        else:
            near = (key > low) & ~taken
            parts = [near, (key > 0.0) & ~(near | taken)] if low > 0.0 else [near]
        first_left = -1
        for part in parts:
            at = part.nonzero()[0]
            at = at[np.argsort(-key[at], kind="stable")]
            total = np.cumsum(cost[at])
            # `right`, because a sum that equals what is left still fits.
            count = int(np.searchsorted(total, budget - spent, side="right"))
            taken[at[:count]] = True
            spent += float(total[count - 1]) if count else 0.0
            if count < len(at):
                first_left = int(at[count])
                break
        self._place = float(key[first_left]) if first_left >= 0 else 0.0
        return Cut(taken, spent, first_left)
