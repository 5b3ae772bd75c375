"""Raising smooth resolutions along the gradient as Zach, Mantler and Karner printed it.

This work is based on: Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous
levels of detail", VRST 2002, sections 3.3 to 3.5: the direction ``a_i = max(0, ∂b/∂x_i - ε/(1 -
x_i))`` in the resolutions themselves, and a line search to where benefit per cost along it falls to
the next increment's, to the first variable that is full, or to the end of the budget.

Readings.  At nothing the gradient of a root has no bound: variables begin at a thousandth of what
they can have at least.  Groups that share a variable have one resolution (constraint 1 of the
print): it rises by the mean of their gradients, which is the gradient within that constraint.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray

_FULL = 1.0 - 1e-12  # a resolution from here on is full
_SLOPE_PRECISION = 2e-10  # relative; finer than slopes that count as equal
_DECADES = 40.0  # natural ones below the longest step, at which a line search begins
_COST_PRECISION = 1e-9
_MAX_PASSES = 60  # of one line search; it takes about ten


@dataclass(frozen=True, slots=True)
class SmoothVariables:
    """V variables of resolution r with benefit ``benefit · sqrt(r)``.

    They cost ``setup · min(r / whole, 1) + full · r``: below `whole` a fraction of a variable's
    things is set up and drawn, each at its lowest.

    Attributes
    ----------
    benefit, setup, full, whole : (V,) float64
    start : (V,) float64
        Resolution to begin with, above 0.
    members : (V,) float64
        Groups that share the variable.
    """

    benefit: FloatArray
    setup: FloatArray
    full: FloatArray
    whole: FloatArray
    start: FloatArray
    members: FloatArray

    def cost(self, r: FloatArray) -> float:
        """Return what resolutions cost, (V,) of them."""
        return float((self.setup * np.minimum(r / self.whole, 1.0) + self.full * r).sum())


class PrintedAscent:
    """Raises by the printed gradient, (V,) variables.

    Attributes
    ----------
    r : (V,) float64
        Resolutions so far.
    passes : int
        Passes over all variables.
    """

    def __init__(self, variables: SmoothVariables, barrier: float) -> None:
        self._of, self.barrier = variables, barrier
        self.r = variables.start.copy()
        self.passes = 0
        self._direction = np.zeros(len(self.r))
        self._per_whole = variables.setup / variables.whole

    def slope(self) -> float:
        """Return benefit per cost along the new search direction; 0 where nothing can be raised."""
        self.passes += 1
        room = 1.0 - self.r
        free = self.r < _FULL
        gradient = self._of.benefit / (2.0 * np.sqrt(self.r) * self._of.members)
        penalty = np.divide(self.barrier, room, out=np.zeros(len(room)), where=free)
        direction = np.where(free, np.maximum(gradient - penalty, 0.0), 0.0)
        # Behind the barrier there is still room, which is worth taking when nothing else is left.
        self._direction = direction if direction.any() else np.where(free, gradient, 0.0)
        return self._slope_at(self.r)

    def raise_to(self, slope: float, spend: float) -> float:
        """Raise until benefit per cost falls to `slope` or `spend` is spent; return what was.

        The direction is the one of the last call of `slope`.
        """
        moving = self._direction > 0.0
        if not moving.any():
            return 0.0
        end = float(((1.0 - self.r[moving]) / self._direction[moving]).min())
        step = end
        if slope > 0.0 and self._slope_at(self._at(end)) < slope:
            step = self._find_slope(slope, end)
        before = self._cost(self.r)
        if self._cost(self._at(step)) - before > spend:
            step = self._find_cost(before + spend, step)
        place = self._at(step)
        self.r = np.where(place >= _FULL, 1.0, place)
        after = self._cost(self.r)
        return after - before

    def _at(self, step: float) -> FloatArray:
        return np.minimum(self.r + step * self._direction, 1.0)

    def _cost(self, r: FloatArray) -> float:
        self.passes += 1
        return self._of.cost(r)

    def _slope_at(self, r: FloatArray) -> float:
        """Return benefit over cost of a little more along the direction, from resolutions `r`."""
        self.passes += 1
        gain = self._direction * self._of.benefit / (2.0 * np.sqrt(r))
        unit = self._of.full + np.where(r < self._of.whole, self._per_whole, 0.0)
        paid = float((self._direction * unit).sum())
        return float(gain.sum()) / paid if paid > 0.0 else math.inf if gain.any() else 0.0

    def _find_slope(self, slope: float, end: float) -> float:
        """Return a step within (0, end) at which benefit per cost is `slope`, or just above it."""
        # Along a ray it falls about as the root of the step does, over many decades: regula falsi
        # in logarithms, with Illinois' halving of the end that stays.
        above, below = math.log(end), math.log(end) - _DECADES
        at_above = self._gap(end, slope)
        at_below = self._gap(math.exp(below), slope)
        if at_below <= 0.0:
            return math.exp(below)
        kept_below, near = 0, below
        for _ in range(_MAX_PASSES):
            middle = (below * at_above - above * at_below) / (at_above - at_below)
            gap = self._gap(math.exp(middle), slope)
            if gap >= 0.0:
                below, at_below, near = middle, gap, middle
                at_above *= 0.5 if kept_below > 0 else 1.0
                kept_below = 1
            else:
                above, at_above = middle, gap
                at_below *= 0.5 if kept_below < 0 else 1.0
                kept_below = -1
            if abs(gap) <= _SLOPE_PRECISION or above - below <= _SLOPE_PRECISION:
                return math.exp(middle)
        return math.exp(near)

    def _gap(self, step: float, slope: float) -> float:
        """Return the logarithm of the slope at a step over the one that is sought."""
        return math.log(max(self._slope_at(self._at(step)), 1e-300) / slope)

    def _find_cost(self, cost: float, end: float) -> float:
        """Return the largest step that costs no more than `cost`, within [0, end]."""
        # Cost rises along a ray, in pieces of lines that grow less steep: a secant never passes it
        # from below, and halving sees to it that it comes near from above too.
        below, above = 0.0, end
        at_below, at_above = self._cost(self.r), self._cost(self._at(end))
        for _ in range(_MAX_PASSES):
            share = (cost - at_below) / max(at_above - at_below, 1e-300)
            middle = below + (above - below) * min(max(share, 0.05), 0.95)
            now = self._cost(self._at(middle))
            if now <= cost:
                below, at_below = middle, now
                if cost - now <= _COST_PRECISION * cost:
                    break
            else:
                above, at_above = middle, now
        return below
