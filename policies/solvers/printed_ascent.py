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
_SLOPE_PRECISION = 2e-4  # of the square, below the slope sought
_OVERSHOOT = 1e-5  # of a secant's step, so that its last one ends below the slope
_LEAST_STEP = 1e-12  # of the bracket: where the slope jumps no step is precise
_COST_PRECISION = 1e-9
_MAX_PASSES = 60  # to find a cost


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
        self._half = 0.5 * variables.benefit
        self._pull = self._half / variables.members
        self._per_whole = variables.setup / variables.whole
        self._spent = variables.cost(self.r)
        self._direction = self._gain = self._setup = np.zeros(len(self.r))
        self._full = 0.0

    def slope(self) -> float:
        """Return benefit per cost along the new search direction; 0 where nothing can be raised."""
        self.passes += 1
        free = self.r < _FULL
        gradient = self._pull / np.sqrt(self.r)
        penalty = self.barrier / np.maximum(1.0 - self.r, 1.0 - _FULL)
        direction = np.maximum(gradient - penalty, 0.0) * free
        # Behind the barrier there is still room, which is worth taking when nothing else is left.
        self._direction = direction if direction.any() else gradient * free
        # What a line search asks of the direction again and again.
        self._gain = self._direction * self._half
        self._setup = self._direction * self._per_whole
        self._full = float(self._direction @ self._of.full)
        return self._slope_at(0.0)

    def raise_to(self, slope: float, spend: float) -> float:
        """Raise until benefit per cost falls to `slope` or `spend` is spent; return what was.

        The direction is the one of the last call of `slope`.
        """
        moving = self._direction > 0.0
        if not moving.any():
            return 0.0
        end = float(((1.0 - self.r[moving]) / self._direction[moving]).min())
        step = end
        if slope > 0.0 and (excess := self._excess(end, slope)) > 0.0:
            step = self._find_slope(slope, end, excess)
        before = self._spent
        if self._cost(self._at(step)) - before > spend:
            step = self._find_cost(before + spend, step)
        place = self._at(step)
        self.r = np.where(place >= _FULL, 1.0, place)
        self._spent = self._cost(self.r)
        return self._spent - before

    def _at(self, step: float) -> FloatArray:
        return np.minimum(self.r + step * self._direction, 1.0)

    def _cost(self, r: FloatArray) -> float:
        self.passes += 1
        return self._of.cost(r)

    def _slope_at(self, step: float) -> float:
        """Return benefit over cost of a little more along the direction, a step from here."""
        self.passes += 1
        r = self.r + step * self._direction
        gain = float(self._gain @ (1.0 / np.sqrt(r)))
        paid = self._full + float(self._setup @ (r < self._of.whole))
        return gain / paid if paid > 0.0 else math.inf if gain > 0.0 else 0.0

    def _find_slope(self, slope: float, end: float, excess: float) -> float:
        """Return a step in (0, end) at which benefit per cost is `slope`, or just below it.

        `excess` is that of the end (`_excess`).
        """
        below, above, at_above = 0.0, end, excess
        at_below = self._excess(0.0, slope)
        side, reached = 0, excess
        # Ending below the slope the increment is taken next, not the same line search once more.
        while reached > _SLOPE_PRECISION and above - below > _LEAST_STEP * above:
            secant = (below * at_above - above * at_below) / (at_above - at_below)
            middle = min(secant + _OVERSHOOT * (secant - below), above)
            excess = self._excess(middle, slope)
            if excess < 0.0:
                below, at_below = middle, excess
                at_above *= 0.5 if side > 0 else 1.0
                side = 1
            else:
                above, at_above, reached = middle, excess, excess
                at_below *= 0.5 if side < 0 else 1.0
                side = -1
        return above

    def _excess(self, step: float, slope: float) -> float:
        """Return by how much a step is too long, about in proportion, negative if too short.

        Slopes fall as the root of a resolution rises, so that the square of their inverse is nearly
        a line: a secant of it, with Illinois' halving of the end that stays, is there at once.
        """
        ratio = slope / max(self._slope_at(step), 1e-300)
        return ratio * ratio - 1.0

    def _find_cost(self, cost: float, end: float) -> float:
        """Return the largest step that costs no more than `cost`, within [0, end]."""
        # Cost rises along a ray, in pieces of lines that grow less steep: a secant never passes it
        # from below, and a share of the bracket at least is left behind each time.
        below, above = 0.0, end
        at_below, at_above = self._spent, self._cost(self._at(end))
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
