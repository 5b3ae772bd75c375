"""The first of many by falling key, without sorting all of them."""

import numpy as np

from ...base.arrays import FloatArray, IntArray

_FIRST_LOOK = 64
_FURTHER = 8


def falling_prefix(
    key: FloatArray, amount: FloatArray, limit: float
) -> tuple[IntArray, FloatArray]:
    """Return positions by falling key and the running sums of their amounts, (k,) each.

    They are as many as it takes for the sum to exceed the limit, or more, or all.  Of equal keys
    the one that stands first comes first.
    """
    count, some = _FIRST_LOOK, np.arange(len(key))
    while count < len(key):
        least = np.partition(key, len(key) - count)[len(key) - count]
        # All of the least key, so that it does not matter which of them the partition has put in.
        first: IntArray = (key >= least).nonzero()[0]
        if float(amount[first].sum()) > limit:
            some = first
            break
        count *= _FURTHER
    order = some[np.argsort(-key[some], kind="stable")]
    return order, np.cumsum(amount[order])
