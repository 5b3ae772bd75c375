"""Separable concave allocation: share a budget so that value gained per cost is equal everywhere.

The one problem behind four papers: choose ``x`` in ``[low, high]`` with ``Σ cost · x <= budget`` so
that the marginal value ``weight · x^-power`` per cost is equal wherever no bound holds, that is
``x(λ) = clip((weight / (λ cost))^(1 / power), low, high)``.

- Gobbetti-Bouvier's degradation ``Σ a r^-m``: weight ``m a``, power ``m + 1``.
- Wimmer-Schmalstieg: the same without bounds.
- Peng's share ``A^(1/α)``: without bounds, power ``α = m + 1``.
- Zach's smooth half ``Σ c sqrt(x)``: weight ``c / 2``, power 1/2.

With ``s = λ^(-1/power)`` and ``t = (weight / cost)^(1 / power)`` an x is ``clip(s t, low, high)``,
so what is spent is piecewise linear in s.  Newton's method on it ends after a few passes, and
exactly: once no x passes a bound during a step, the step leads to the solution.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray

_PLAIN_PASSES = 16
"""Passes after which every other one halves the bracket, so that no input can stall Newton."""


@dataclass(frozen=True, slots=True)
class Allocation:
    """Shares of a budget.

    Attributes
    ----------
    x : (n,) float64
    multiplier : float
        λ, the value per cost of the last unit spent: 0 where the budget pays for everything,
        infinite where it does not even pay for `low`.
    feasible : bool
        Whether the budget pays for `low`; if not, x is `low`.
    converged : bool
        Whether x is the optimum, or the feasible point at which the solver had to stop.
    iterations, comparisons : passes over all x, and comparisons made in them
    """

    x: FloatArray
    multiplier: float
    feasible: bool
    converged: bool
    iterations: int
    comparisons: int


@dataclass(frozen=True, slots=True)
class Shares:
    """A problem to solve: the arguments of `allocate`, with bounds as arrays, (n,)."""

    weight: FloatArray
    cost: FloatArray
    budget: float
    power: float
    low: FloatArray
    high: FloatArray

    def unit(self) -> FloatArray:
        """Return ``t = (weight / cost)^(1 / power)``, (n,); infinite where nothing is paid."""
        if float(self.cost.min(initial=math.inf)) > 0.0:
            ratio = self.weight / self.cost
        else:
            infinite = np.full(len(self.cost), np.inf)
            ratio = np.divide(self.weight, self.cost, out=infinite, where=self.cost > 0.0)
        # m = 1 and m = 2, the usual degradations: these roots are about twice as fast as a power.
        if self.power == 2.0:
            return np.sqrt(ratio, out=ratio)
        if self.power == 3.0:
            return np.cbrt(ratio, out=ratio)
        return np.power(ratio, 1.0 / self.power, out=ratio)

    def settle(self) -> Allocation | None:
        """Return the shares where the budget leaves no choice, all at `high` or all at `low`."""
        cost, budget, low, count = self.cost, self.budget, self.low, len(self.cost)
        top = self.high
        for _ in range(2):  # everything in full, else everything that is worth something
            if not count or (math.isfinite(top.max()) and float(cost @ top) <= budget):
                feasible = count > 0 or budget >= 0.0
                return Allocation(top.copy(), 0.0, feasible, True, 1, count)
            if self.weight.min() > 0.0:
                break
            top = np.where(self.weight > 0.0, self.high, low)
        floor = float(cost @ low)
        if floor < budget:
            return None
        multiplier = math.inf
        # The budget pays for just `low`: λ is the least price that keeps every x there.
        if floor == budget and low.min() > 0.0:
            multiplier = float((self.unit() / low).max()) ** self.power
        return Allocation(low.copy(), multiplier, floor <= budget, True, 1, count)


def allocate(
    weight: FloatArray,
    cost: FloatArray,
    budget: float,
    *,
    power: float,
    low: FloatArray | float = 0.0,
    high: FloatArray | float = math.inf,
) -> Allocation:
    """Return the optimal shares by a safeguarded Newton iteration on the multiplier.

    `weight` and `cost` are (n,), not negative; `low` and `high` scalars or (n,) with
    ``0 <= low <= high``, `high` finite where the cost is 0.  What costs nothing is at `high`; what
    weighs nothing is at `low` unless everything can be at `high`.
    """
    low, high = np.broadcast_to(low, len(cost)), np.broadcast_to(high, len(cost))
    return solve(Shares(weight, cost, budget, power, low, high))


def solve(shares: Shares) -> Allocation:
    """Return the optimal shares, as `allocate`."""
    early = shares.settle()
    if early is not None:
        return early
    share, cost, budget = shares.unit(), shares.cost, shares.budget
    low, high = shares.low, shares.high
    paid = np.multiply(cost, share, out=np.zeros(len(cost)), where=cost > 0.0)
    scale, below, above = budget / float(paid.sum()), 0.0, math.inf
    was_low = was_high = np.zeros(len(cost), dtype=np.bool_)
    newton = True  # the first scale is the step with no bound held
    iterations = 0
    while True:
        iterations += 1
        x = np.minimum(np.maximum(scale * share, low), high)
        at_low, at_high = x <= low, x >= high
        gap = budget - float(cost @ x)
        same = np.array_equal(at_low, was_low) and np.array_equal(at_high, was_high)
        # Bounds that hold now held before the step: it stayed on one linear piece of what is spent,
        # so Newton's step has ended on the root, not near it.
        if gap == 0.0 or (newton and same):
            break
        # A budget for all of `high` that lost a bit to rounding: no scale would ever spend it.
        if gap > 0.0 and at_high.all():
            break
        # What is spent rises with the scale: the sign of the gap says on which side the root lies.
        below, above = (scale, above) if gap > 0.0 else (below, scale)
        # Only variables between their bounds follow the scale.
        slope = float(paid @ ~(at_low | at_high))
        following = scale + gap / slope if slope > 0.0 else scale
        newton = below < following < above and (iterations <= _PLAIN_PASSES or iterations % 2 == 1)
        # A Newton step too short to change the scale is convergence, not a reason to halve.
        if not newton and (slope == 0.0 or following != scale):
            following = halve(below, above)
        # No other double is left between the ends: the scale cannot be told more exactly.
        if following in {scale, below, above}:
            break
        scale, was_low, was_high = following, at_low, at_high
    comparisons = 2 * len(cost) * iterations
    return Allocation(x, scale**-shares.power, True, True, iterations, comparisons)


def halve(below: float, above: float) -> float:
    """Return the middle of a bracket on a logarithmic scale; a step out where it has no end yet."""
    if above == math.inf:
        return 4.0 * below
    return math.sqrt(below) * math.sqrt(above) if below > 0.0 else 0.25 * above
