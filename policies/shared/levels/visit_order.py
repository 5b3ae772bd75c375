"""In which order LODManager visits objects: whoever is furthest off first."""

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ...view import View


def in_order(
    seen: View, lod: FloatArray, slot: IntArray, gap: FloatArray, at: IntArray
) -> IntArray:
    """Return positions by falling gap, of equal ones from the median of their slot outwards."""
    off_median = np.abs(lod[at] - median_of_slot(lod, slot, at))
    return at[np.lexsort((seen.distance_m[at], off_median, -gap[at]))]


def median_of_slot(lod: FloatArray, slot: IntArray, at: IntArray) -> FloatArray:
    """Return for objects at some positions the lower median of the factors wanted in their slot."""
    if not len(at):
        return np.zeros(0)
    asked = np.zeros(int(slot.max()) + 1, dtype=np.bool_)
    asked[slot[at]] = True
    some = asked.take(slot).nonzero()[0]
    some = some[np.lexsort((lod[some], slot[some]))]
    ordered = slot[some]
    first = np.searchsorted(ordered, slot[at], side="left")
    last = np.searchsorted(ordered, slot[at], side="right") - 1
    return lod[some[(first + last) // 2]]
