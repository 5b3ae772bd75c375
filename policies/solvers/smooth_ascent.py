"""Raising smooth variables of benefit ``Σ weight · sqrt(x)`` and cost ``Σ x``, step by step.

This work is based on: Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous
levels of detail", VRST 2002, section 3.4: a search direction along the gradient with a barrier
before full resolution, and a line search to where benefit per cost falls to a given slope.

Differences.  The gradient is taken in ``sqrt(x)``, in which the benefit is linear: there the ray
from nothing is the path of the optimum, ``x ∝ weight²``, whereas steps along the gradient in x end
at ``x ∝ weight^(2/3)`` and, since resolutions only rise, cannot leave it.  A ray may be bent along
a bound that it meets instead of ended there, which spares a step for each variable that reaches it.
"""

import math
from typing import TypeAlias

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .allocation import allocate

_PRECISION = 1e-12  # relative, of slopes and costs
_MAX_PASSES = 100  # of one line search; it takes about ten


class NewtonAscent:
    """Raises by the closed form ``x = (weight / 2 slope)²`` within bounds; exact."""

    def __init__(self, weight: FloatArray, low: FloatArray, high: FloatArray) -> None:
        self._weight, self._low, self._high = weight, low, high
        self.x = low.copy()
        self.passes = 0

    def slope(self) -> float:
        """Return the largest benefit per cost of any variable that can be raised."""
        self.passes += 1
        root = 2.0 * np.sqrt(self.x)
        value = np.divide(self._weight, root, out=np.full(len(root), math.inf), where=root > 0.0)
        return float(value.max(initial=0.0, where=(self.x < self._high) & (self._weight > 0.0)))

    def raise_to(self, slope: float, spend: float) -> float:
        """Raise until benefit per cost falls to `slope` or `spend` is spent; return what was."""
        before = float(self.x.sum())
        self.passes += 1
        # d/dx of weight · sqrt(x) equals the slope at x = (weight / 2 slope)².
        root = self._weight / (2.0 * slope) if slope > 0.0 else np.full(len(self.x), math.inf)
        x = np.clip(np.square(root), self._low, self._high)
        # Too dear down to that slope: `spend` alone decides, by the same closed form.
        if float(x.sum()) - before > spend:
            ones = np.ones(len(x))
            low, high = self._low, self._high
            result = allocate(
                0.5 * self._weight, ones, before + spend, power=0.5, low=low, high=high
            )
            self.passes += result.iterations
            x = result.x
        # Rounding must not take back what an earlier step has given.
        self.x = np.maximum(x, self.x)
        return float(self.x.sum()) - before


class GradientAscent:
    """Raises along the gradient: ``a = max(0, weight · (1 - barrier / (1 - w)))``.

    w in [0, 1] is the root of a variable over that of its highest value, so that the barrier is in
    units of the variable's own gradient.  A variable below its lowest value has that value, and
    costs no more, until the ray lifts it.  A ray ends where the first variable reaches its highest
    value, as printed, or where all have that move, if it is `bent`.
    """

    def __init__(
        self, weight: FloatArray, low: FloatArray, high: FloatArray, *, barrier: float, bent: bool
    ) -> None:
        """Begin at `low`; `weight`, `low` and `high` are (V,) and not negative."""
        self._bent = bent
        self._weight = np.where(high > low, weight, 0.0)
        self._low, self._high = np.sqrt(low), np.sqrt(high)
        self._at = np.zeros(len(weight))
        self._direction = self._weight
        self.barrier = barrier
        self.passes = 0

    @property
    def x(self) -> FloatArray:
        """Current values, (V,)."""
        return np.square(np.clip(self._at, self._low, self._high))

    def slope(self) -> float:
        """Return benefit per cost along the new search direction; 0 where nothing can be raised."""
        self.passes += 1
        if not len(self._at):
            return 0.0
        self._direction = self._search_direction()
        rising = self._direction > 0.0
        if not rising.any():
            return 0.0
        if not (rising & (self._at >= self._low)).any():
            self._lift(rising)
        # Along the ray the benefit rises by Σ a · weight and the cost, Σ place², by 2 Σ a · place.
        value, drift, _ = self._moments(self._at)
        return value / (2.0 * drift) if drift > 0.0 else math.inf

    def _search_direction(self) -> FloatArray:
        room = np.ones(len(self._at))
        np.divide(self._at, self._high, out=room, where=self._high > 0.0)
        np.subtract(1.0, room, out=room)
        free = (room > 0.0) & (self._weight > 0.0)
        penalty = np.divide(self.barrier, room, out=np.ones(len(room)), where=free)
        direction = self._weight * np.maximum(1.0 - penalty, 0.0)
        # Behind the barrier there is still room, which is worth taking when nothing else is left.
        return direction if direction.any() else np.where(free, self._weight, 0.0)

    def _lift(self, rising: BoolArray) -> None:
        """Go on, at no cost, to where the first variable leaves its lowest value."""
        until = np.full(len(self._at), math.inf)
        np.divide(self._low - self._at, self._direction, out=until, where=rising)
        first = int(until.argmin())
        self._at = self._at + until[first] * self._direction
        self._at[first] = max(self._at[first], self._low[first])

    def raise_to(self, slope: float, spend: float) -> float:
        """Raise until benefit per cost falls to `slope` or `spend` is spent; return what was.

        The direction is the one of the last call of `slope`.
        """
        before = self._cost(self._at)
        end = self._end()
        step = self._find_slope(slope, end) if slope > 0.0 else end
        if self._cost(self._at + step * self._direction) - before > spend:
            step = self._find_cost(before + spend, step)
        place = self._at + step * self._direction
        # What is to reach its highest value does so whatever was rounded.
        self._at = np.where(place >= self._high * (1.0 - _PRECISION), self._high, place)
        return self._cost(self._at) - before

    def _end(self) -> float:
        """Return where the ray ends: variables that move now have reached their highest value."""
        moving = (self._direction > 0.0) & (self._at >= self._low)
        until = (self._high[moving] - self._at[moving]) / self._direction[moving]
        return float(until.max() if self._bent else until.min())

    def _find_slope(self, slope: float, end: float) -> float:
        """Return the step at which value = 2 slope · (drift + step · speed), within [0, end]."""
        below, above = 0.0, end
        # Right but for the barrier, and for what still waits below its lowest value or is full.
        ray, self.passes = self._direction, self.passes + 1
        drift, speed = float((ray * self._at).sum()), float((ray * ray).sum())
        step = (float((ray * self._weight).sum()) / (2.0 * slope) - drift) / speed
        step = min(max(step, below), above)
        for _ in range(_MAX_PASSES):
            # As long as the same variables move, `gap` falls by 2 slope · speed a unit of step.
            value, drift, speed = self._moments(self._at + step * self._direction)
            gap = value - 2.0 * slope * drift
            if value > 0.0 and abs(gap) <= _PRECISION * value:
                return step
            below, above = (step, above) if gap > 0.0 else (below, step)
            following = step + gap / (2.0 * slope * speed) if speed > 0.0 else above
            step = following if below < following < above else 0.5 * (below + above)
            if above - below <= _PRECISION * above:
                break
        # Either no step was too long, and the ray ends before its slope has fallen that far, or
        # this is the end of the bracket at which raising still pays.
        return above if above == end else below

    def _find_cost(self, cost: float, end: float) -> float:
        """Return the largest step that costs no more than `cost`, within [0, end]."""
        below, above, step = 0.0, end, end
        for _ in range(_MAX_PASSES):
            place = self._at + step * self._direction
            gap = cost - self._cost(place)
            if 0.0 <= gap <= _PRECISION * cost:
                return step
            below, above = (step, above) if gap > 0.0 else (below, step)
            _, drift, _ = self._moments(place)
            # Aims a little short, because only steps that are not too dear count.
            following = step + (gap - 0.5 * _PRECISION * cost) / (2.0 * drift) if drift else below
            step = following if below < following < above else 0.5 * (below + above)
            if above - below <= _PRECISION * above:
                break
        return below

    def _moments(self, place: FloatArray) -> tuple[float, float, float]:
        """Return direction times weight, place and direction, over what moves at `place`."""
        self.passes += 1
        moving = (place >= self._low) & (place < self._high)
        direction = self._direction * moving
        return (
            float((direction * self._weight).sum()),
            float((direction * place).sum()),
            float((direction * self._direction).sum()),
        )

    def _cost(self, place: FloatArray) -> float:
        self.passes += 1
        root = np.clip(place, self._low, self._high)
        return float((root * root).sum())


Ascent: TypeAlias = NewtonAscent | GradientAscent
"""Smooth variables that can be raised; `passes` counts passes over all of them."""
