"""Active-set search for the separable concave allocation, as Gobbetti and Bouvier describe it.

Each pass solves the problem in which the working set of bounds holds with equality, which has the
closed form ``x_i = t_i (budget - Σ_held cost · x) / Σ_free cost · t``.  It goes there as far as no
bound is broken and takes the bounds that it meets into the working set.  Where the whole step is
possible, the multipliers of the held bounds say whether that point is the optimum; if not, the
bound with the most negative multiplier leaves the set.  Every point on the way keeps all bounds and
the budget, so the search may stop anywhere.

This work is based on: Gobbetti and Bouvier, Time-critical multiresolution rendering of large
complex models (CAD 2000); the formulas, lost in the text at hand, are restored in the project's
notes.
"""

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from .allocation import Allocation, Shares
from .falling_prefix import falling_prefix
from .near_bounds import NearBounds, Where

_SHRINK = 0.8
"""Factor by which a start that is too dear is scaled down; the paper's is lost, this is ours."""

_TOLERANCE = 1e-12
"""Relative size below which a multiplier counts as zero and a budget as spent."""


def search_active_set(
    shares: Shares, *, max_iterations: int, start: FloatArray | None = None
) -> Allocation:
    """Return the optimal shares, or a feasible point after `max_iterations` passes.

    As `solve`, but `low` is positive.  `start`, (n,), is where to begin, such as the shares of the
    last frame; it is brought within the bounds and the budget.  Without it, begin at `low`.
    """
    early = shares.settle()
    if early is not None:
        return early
    search = _Search(shares)
    if start is not None:
        search.begin(np.clip(start, shares.low, shares.high), max_iterations)
    converged = False
    while not converged and search.iterations < max_iterations:
        converged = search.step()
    return Allocation(
        search.x, search.multiplier, True, converged, search.iterations, search.comparisons
    )


class _Search:
    """A feasible point and the bounds held with equality.

    What is free moves in proportion to its unit t: x is ``(part · place + rest) · t``, two numbers
    for all and a place of each, so that a pass only looks at what is about to meet a bound.
    """

    def __init__(self, shares: Shares) -> None:
        self.weight, self.cost = shares.weight, shares.cost
        self.budget, self.power = shares.budget, shares.power
        self.low, self.high = shares.low, shares.high
        self.iterations, self.comparisons, self.multiplier = 0, 0, 0.0
        # What costs nothing is at its upper bound, and what weighs nothing at its lower, for good.
        self.held_high = (self.cost <= 0.0) | (self.low >= self.high)
        self.held_low = (self.weight <= 0.0) & ~self.held_high
        held = self.held_high | self.held_low
        self.free = ~held
        self.unit = shares.unit()
        self.held_x = np.zeros(len(self.cost))
        some = bool(held.any())
        if some:
            # The unit is infinite where the cost is 0; with 0, sums over everything need no mask.
            self.unit[self.held_high] = 0.0
            self.held_x = np.where(self.held_high, self.high, np.where(held, self.low, 0.0))
        self.paid = np.where(self.held_low, 0.0, self.unit * self.cost)
        # What is held stands at 1 there, out of reach of anything.
        unit = np.where(self.free, self.unit, 1.0) if some else self.unit
        lowest = self.low / unit
        falling, rising = -lowest, self.high / unit
        if some:
            falling[held] = rising[held] = np.inf
        self.above, self.below = NearBounds(rising, 1.0), NearBounds(falling, -1.0)
        # `settle` has shown that the budget pays for more than `low`: it is a feasible start.
        self.place, self.part, self.rest = lowest, 1.0, 0.0
        self._count_free()

    @property
    def x(self) -> FloatArray:
        """The point, (n,); rounding does not carry it past a bound: it is feasible to the bit."""
        x = self.part * self.place
        x += self.rest
        x *= self.unit
        np.minimum(np.maximum(x, self.low, out=x), self.high, out=x)
        return np.where(self.free, x, self.held_x)

    def begin(self, start: FloatArray, max_iterations: int) -> None:
        """Begin at `start`, scaled down as far as the budget needs, or at `low` if that takes long.

        Objects of the highest degradation per cost are scaled first, all by the same factor; if the
        budget is still exceeded after the last, another round follows, which counts as a pass.
        """
        x = np.where(self.free, start, self.held_x)
        excess = float(self.cost @ x) - self.budget
        # An excess by rounding, as at the optimum of the frame before, is none.
        while excess > _TOLERANCE * self.budget:
            # Out of passes: the point still is `low`, which keeps every bound and the budget.
            if self.iterations == max_iterations:
                return
            # Degradation over cost is proportional to (unit / x)^power, which sorts alike.
            less = np.where(self.free, np.maximum(_SHRINK * x, self.low), x)
            # No more objects than are needed: up to where the savings first make up for the excess.
            order, saved = falling_prefix(self.unit / x, self.cost * (x - less), excess)
            scaled = order[: int(np.searchsorted(saved, excess)) + 1]
            x[scaled] = less[scaled]
            excess = float(self.cost @ x) - self.budget
            self.iterations += 1
            self.comparisons += int(len(x) * np.log2(len(x) + 1))
        np.divide(x, self.unit, out=self.place, where=self.free)

    def step(self) -> bool:
        """Make one pass; return whether the point is the optimum."""
        self.iterations += 1
        self.comparisons += 2 * len(self.cost)
        # With what is held fixed, the minimiser spends the rest of the budget on x = scale · t:
        # the closed form at the top of this file.
        if self.wanted > 0.0:
            # Positive, as the present point keeps the budget and its free variables cost something.
            scale = (self.budget - self.spent) / self.wanted
            if not self._reach(scale):
                return False
            # weight · x^-power = λ · cost with x = scale · t gives λ = scale^-power, t cancelling.
            self.multiplier = scale**-self.power
            x = self.x
        else:
            x = self.x
            self.multiplier = self._multiplier_at_vertex(x)
        return self._release(x)

    def _reach(self, scale: float) -> bool:
        """Go towards the solution of the working set; return whether no bound was in the way."""
        # Present point and target keep the budget, and the cost is linear in x, so every point
        # between them does too.
        where = Where(self.place, self.part, self.rest, scale)
        up, down = self.above.first(where), self.below.first(where)
        length = min(up.length, down.length)
        if not self.above.sure(where, length):
            up = self.above.first_of_all(where)
            length = min(up.length, down.length)
        if not self.below.sure(where, length):
            down = self.below.first_of_all(where)
            length = min(up.length, down.length)
        if length >= 1.0:
            self.part, self.rest = 0.0, scale
            return True
        # The nearest bound ends the step.  Bounds met at the same length enter together, which
        # spares a pass for each tie.
        if up.length == length:
            self._hold(up.variables, self.high, self.held_high)
        if down.length == length:
            self._hold(down.variables, self.low, self.held_low)
        self.part *= 1.0 - length
        self.rest += length * (scale - self.rest)
        return False

    def _hold(self, variables: IntArray | list[int], bound: FloatArray, held: BoolArray) -> None:
        if len(variables) == 1:  # the rule, and much faster than as an array of one
            at = int(variables[0])
            paid, spent = float(self.paid[at]), float(self.cost[at]) * float(bound[at])
        else:
            at = np.asarray(variables)
            paid, spent = float(self.paid[at].sum()), float(self.cost[at] @ bound[at])
        self.wanted -= paid
        self.spent += spent
        self.held_x[at] = bound[at]
        self.paid[at] = 0.0
        self.free[at] = False
        held[at] = True
        self.above.strike(variables)
        self.below.strike(variables)
        # What a difference has lost of its digits is made good before it matters.
        if self.wanted < 0.5 * self.known:
            self._count_free()

    def _count_free(self) -> None:
        """Sum what a unit of everything free costs, and what is spent on the rest."""
        self.wanted = self.known = float(self.paid.sum())
        self.spent = float(self.cost @ self.held_x)

    def _multiplier_at_vertex(self, x: FloatArray) -> float:
        """Return λ where every bound is held: 0 with budget left, else what `low` demands."""
        # Budget left over: complementary slackness makes its multiplier 0.
        if float(self.cost @ x) < self.budget * (1.0 - _TOLERANCE):
            return 0.0
        # No free variable determines λ.  Lower bounds hold if λ is at least (unit / low)^power;
        # with the least such λ only the upper bounds are left to be tested.
        demand = np.where(self.held_low, self.unit / self.low, 0.0)
        return float(demand.max()) ** self.power

    def _release(self, x: FloatArray) -> bool:
        """Let go of the bound with the most negative multiplier, or return that there is none."""
        price = self.multiplier * self.cost
        value = self.weight * x**-self.power
        # The bounds' own multipliers: negative where leaving the bound would lower the degradation.
        slack = np.where(self.held_low, price - value, np.where(self.held_high, value - price, 0.0))
        # Between equal bounds there is no way to go, whatever the sign.
        slack[self.low >= self.high] = 0.0
        worst = int(slack.argmin())
        # Relative to the terms of the difference: the search would cycle on what is rounding.
        if slack[worst] >= -_TOLERANCE * max(price[worst], value[worst]):
            return True
        self.held_low[worst] = self.held_high[worst] = False
        self.held_x[worst] = 0.0
        unit = self.unit[worst]
        self.paid[worst] = self.cost[worst] * unit
        self._count_free()
        # All that is free is at the target; what is let go of begins at its bound.
        self.place.fill(self.rest)
        self.place[worst] = x[worst] / unit
        self.part, self.rest, self.free[worst] = 1.0, 0.0, True
        for side, bound in ((self.above, self.high), (self.below, self.low)):
            side.renew(worst, bound[worst] / unit)
        return False
