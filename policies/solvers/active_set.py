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

from ...base.arrays import FloatArray, IntArray
from .allocation import Allocation, Shares

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

    `share` and `paid` are t and cost · t of what is free and 0 of what is held; `held_x` is x of
    what is held and 0 of what is free.  So a pass is a few operations on whole arrays.
    """

    def __init__(self, shares: Shares) -> None:
        self.weight, self.cost = shares.weight, shares.cost
        self.budget, self.power = shares.budget, shares.power
        self.low, self.high = shares.low, shares.high
        # `settle` has shown that the budget pays for more than `low`: it is a feasible start.
        self.x = self.low.copy()
        self.iterations, self.comparisons, self.multiplier = 0, 0, 0.0
        # What costs nothing is at its upper bound, and what weighs nothing at its lower, for good.
        self.held_high = (self.cost <= 0.0) | (self.low >= self.high)
        # The unit is infinite where the cost is 0; with 0 there, sums over everything need no mask.
        self.unit = np.where(self.held_high, 0.0, shares.unit())
        self.held_low = (self.weight <= 0.0) & ~self.held_high
        self.share, self.paid = self.unit.copy(), self.unit * self.cost
        self.held_x = np.zeros(len(self.cost))
        self._hold(np.flatnonzero(self.held_high), np.flatnonzero(self.held_low))

    def begin(self, start: FloatArray, max_iterations: int) -> None:
        """Begin at `start`, scaled down as far as the budget needs, or at `low` if that takes long.

        Objects of the highest degradation per cost are scaled first, all by the same factor; if the
        budget is still exceeded after the last, another round follows, which counts as a pass.
        """
        held = self.held_low | self.held_high
        x = np.where(held, self.x, start)
        excess = float(self.cost @ x) - self.budget
        while excess > 0.0:
            # Out of passes: `self.x` still is `low`, which keeps every bound and the budget.
            if self.iterations == max_iterations:
                return
            # Degradation over cost is proportional to (unit / x)^power, which sorts alike.
            order = np.argsort(-(self.unit / x), kind="stable")
            less = np.where(held, x, np.maximum(_SHRINK * x, self.low))
            # No more objects than are needed: up to where the savings first make up for the excess.
            saved = np.cumsum((self.cost * (x - less))[order])
            count = int(np.searchsorted(saved, excess)) + 1
            x[order[:count]] = less[order[:count]]
            excess = float(self.cost @ x) - self.budget
            self.iterations += 1
            self.comparisons += int(len(x) * np.log2(len(x) + 1))
        self.x = x

    def step(self) -> bool:
        """Make one pass; return whether the point is the optimum."""
        self.iterations += 1
        self.comparisons += 2 * len(self.x)
        # With what is held fixed, the minimiser spends the rest of the budget on x = scale · t:
        # the closed form at the top of this file.
        wanted = float(self.paid.sum())
        if wanted > 0.0:
            # Positive, as the present point keeps the budget and its free variables cost something.
            scale = (self.budget - float(self.cost @ self.held_x)) / wanted
            if not self._reach(scale):
                return False
            # weight · x^-power = λ · cost with x = scale · t gives λ = scale^-power, t cancelling.
            self.multiplier = scale**-self.power
        else:
            self.multiplier = self._multiplier_at_vertex()
        return self._release()

    def _reach(self, scale: float) -> bool:
        """Go towards the solution of the working set; return whether no bound was in the way."""
        # Present point and target keep the budget, and the cost is linear in x, so every point
        # between them does too.
        target = scale * self.share
        target += self.held_x
        falls, rises = target < self.low, target > self.high
        broken = np.flatnonzero(falls | rises)
        if not len(broken):
            self.x = target
            return True
        low, high, x = self.low[broken], self.high[broken], self.x[broken]
        # Share of the way at which each broken bound lies; the nearest one ends the step.
        part = (np.where(falls[broken], low, high) - x) / (target[broken] - x)
        length = float(part.min())
        # Bounds met at the same length enter together, which spares a pass for each tie.
        met = broken[part <= length]
        target -= self.x
        target *= length
        self.x += target
        # Rounding must not carry a variable past its bound: points are feasible to the bit.
        self.x[broken] = np.minimum(np.maximum(self.x[broken], low), high)
        self._hold(met[rises[met]], met[falls[met]])
        return False

    def _hold(self, at_high: IntArray, at_low: IntArray) -> None:
        for at, bound, held in (
            (at_high, self.high, self.held_high),
            (at_low, self.low, self.held_low),
        ):
            self.x[at] = self.held_x[at] = bound[at]
            self.share[at] = self.paid[at] = 0.0
            held[at] = True

    def _multiplier_at_vertex(self) -> float:
        """Return λ where every bound is held: 0 with budget left, else what `low` demands."""
        # Budget left over: complementary slackness makes its multiplier 0.
        if float(self.cost @ self.x) < self.budget * (1.0 - _TOLERANCE):
            return 0.0
        # No free variable determines λ.  Lower bounds hold if λ is at least (unit / low)^power;
        # with the least such λ only the upper bounds are left to be tested.
        demand = np.where(self.held_low, self.unit / self.low, 0.0)
        return float(demand.max()) ** self.power

    def _release(self) -> bool:
        """Let go of the bound with the most negative multiplier, or return that there is none."""
        price = self.multiplier * self.cost
        value = self.weight * self.x**-self.power
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
        self.share[worst] = self.unit[worst]
        self.paid[worst] = self.cost[worst] * self.unit[worst]
        return False
