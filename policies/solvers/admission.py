"""Which of many things to draw at all, where each costs something whatever its resolution.

Drawing one costs ``setup + x``, x between bounds, and its benefit is ``weight · sqrt(x)``.  The
tangent from nothing to this touches it at ``x = setup``: less is never worth the setup.  So with
``x = scale · weight²``, the same scale for all, a thing is drawn where this is at least its setup
and its least x, and the largest scale that the budget pays for decides.

It stands for the small detail culling of Zach, Mantler and Karner (VRST 2002, section 5.4), "to
avoid expensive transformations", without a threshold that would depend on scene and machine.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray

_LEAST_SCALE = 1e-40  # of the greatest; where bisection begins, on a logarithmic scale
_NEAR = 2.0  # ratio of bounds at which it ends


@dataclass(frozen=True, slots=True)
class Admission:
    """Things to draw, and what the best use of the budget would spend on them.

    Attributes
    ----------
    drawn : (u,) int
        In ascending order.
    scale : float
        At least ``x / weight²`` of what is between its bounds in the best use of the budget by the
        things drawn, but not by far.
    comparisons : int
    """

    drawn: IntArray
    scale: float
    comparisons: int


def admit(
    setup: FloatArray,
    low: FloatArray,
    high: FloatArray,
    weight: FloatArray,
    optional: BoolArray,
    budget: float,
) -> Admission | None:
    """Return what to draw, by rising scale at which it is worth it; arrays are (n,).

    What is not optional is drawn first; None if the budget does not pay for it at `low`.
    """
    squared = np.square(weight)
    entry = np.minimum(np.maximum(setup, low), high)
    key = np.divide(entry, squared, out=np.zeros(len(entry)), where=squared > 0.0)
    key[~optional] = -1.0  # before what is optional but costs nothing to draw
    order = np.argsort(key, kind="stable")
    table = _Table(np.stack((squared, setup, low, high))[:, order])
    fewest, most = int(len(order) - np.count_nonzero(optional)), len(order)
    if table.spent(0.0, fewest) > budget:
        return None
    # What the first k cost at the scale of the k-th rises with k, as both k and the scale do.
    while fewest < most:
        count = (fewest + most + 1) // 2
        if table.spent(float(key[order[count - 1]]), count) <= budget:
            fewest = count
        else:
            most = count - 1
    drawn = order[:fewest]
    edge = float(key[order[fewest]]) if fewest < len(order) else 0.0
    scale = table.scale(fewest, edge, budget)
    comparisons = len(order) * len(order).bit_length() + table.comparisons
    return Admission(np.sort(drawn), scale, comparisons)


class _Table:
    """Square of weight, setup, least and greatest x, by the scale at which each is drawn."""

    def __init__(self, columns: FloatArray) -> None:
        self._columns = columns
        self.comparisons = 0

    def spent(self, scale: float, count: int) -> float:
        """Return what the first `count` cost at a scale."""
        squared, setup, low, high = self._columns[:, :count]
        self.comparisons += 2 * count
        return float((np.clip(scale * squared, low, high) + setup).sum())

    def scale(self, count: int, edge: float, budget: float) -> float:
        """Return a scale at which the first `count` cost at least `budget`, or all are full.

        `edge` is the scale at which one more would be drawn, 0 if there is none.
        """
        squared, _, _, high = self._columns[:, :count]
        full = np.divide(high, squared, out=np.zeros(count), where=squared > 0.0)
        above = float(full.max(initial=0.0))
        below = _LEAST_SCALE * above
        # One look at the scale of the next thing shows on which side of it the answer lies.
        if below < edge < above:
            below, above = (edge, above) if self.spent(edge, count) < budget else (below, edge)
        while above > _NEAR * below:
            # Geometric mean, as scales span decades; roots apart, so that no product underflows.
            middle = float(np.sqrt(below)) * float(np.sqrt(above))
            low_enough = self.spent(middle, count) < budget
            below, above = (middle, above) if low_enough else (below, middle)
        return above
