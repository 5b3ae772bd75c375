"""Time divided among siblings by priority, as the HLOD thesis does, and what is left over too."""

import numpy as np

from ....base.arrays import FloatArray, IntArray


def divide_time(
    parent: IntArray, share_ms: FloatArray, priority: FloatArray, most_ms: FloatArray | None
) -> FloatArray:
    """Return the time slice of each of m siblings, (m,): ``share · priority / Σ priority``.

    Nobody gets more than `most_ms`; what a slice would have beyond that goes to the siblings that
    can use it, by priority again.  What nobody can use is lost.

    Parameters
    ----------
    parent
        Family of each sibling, (m,): an index of `share_ms`.
    share_ms
        Time of each family.
    priority, most_ms
        (m,) each, priorities above 0; None for no bound.
    """
    families = len(share_ms)
    left_ms = np.maximum(share_ms, 0.0)
    open_ = np.ones(len(parent), dtype=np.bool_)
    slice_ms = np.zeros(len(parent))
    while True:
        weight = priority * open_
        whole = np.bincount(parent, weight, minlength=families)[parent]
        slice_ms[open_] = (left_ms[parent] * priority / np.maximum(whole, 1e-300))[open_]
        if most_ms is None:
            return slice_ms
        # Each turn gives at least one sibling its most, and takes it out: m turns at worst, as many
        # as a family has distinct ratios, which is few.
        full = open_ & (slice_ms > most_ms)
        if not full.any():
            return slice_ms
        slice_ms[full] = most_ms[full]
        left_ms = left_ms - np.bincount(parent[full], most_ms[full], minlength=families)
        open_ &= ~full
