"""Active-set search for the separable concave allocation, after Gobbetti and Bouvier.

Each pass solves the problem in which the working set of bounds holds with equality, which has the
closed form ``x_i = t_i (budget - Σ_held cost · x) / Σ_free cost · t``.  Bounds that its solution
breaks enter the working set, bounds whose multiplier is negative leave it, and once the solution
breaks no bound and no multiplier is negative it is the optimum.

The paper moves one bound a pass; here all move at once.  As ``x = scale · t`` wherever no bound
holds, the bounds that enter and leave are those at which ``clip(scale · t, low, high)`` begins and
ceases to stand, and a held bound's multiplier is negative just where ``scale · t`` is inside it.
So a pass is a step of a semismooth Newton method on the scale, as Hintermüller, Ito and Kunisch
showed of such exchanges in general, and two or three passes do where, one bound at a time, 20 were
needed on average along the bundled tour and a frame of five was cut off at 48.  Exchanges that
would lead back to where the search has been are cut short in the middle.

Every pass bounds the scale from below, by a point that keeps the budget, or from above, by one that
does not.  Where the budget ends on the way from the nearest of the former, which only improves, to
the nearest of the latter there is a point that keeps all bounds and is no worse than the former:
the search may stop anywhere.

This work is based on: Gobbetti and Bouvier, Time-critical multiresolution rendering of large
complex models (CAD 2000), whose formulas, lost in the text at hand, are restored in the project's
notes; and Hintermüller, Ito and Kunisch, The primal-dual active set strategy as a semismooth Newton
method (SIAM Journal on Optimization 13, 2003).
"""

import math

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .allocation import Allocation, Shares, halve

_ROUNDING = 1e-15
"""Share of the budget that one sum of what is spent cannot tell from nothing."""

_TOLERANCE = 1e-12
"""Share of the budget up to which a closed form, which spends all of it, may miss it by rounding.

Larger than `_ROUNDING` because the gap that led there was the rounded sum of another point.
"""


class ActiveSet:
    """Searches one frame after another, each from the working set at which the last one ended.

    Attributes
    ----------
    stand : float
        The last frame's scale over the scale at which no bound would hold.  Times this frame's it
        gives the bounds to begin with: a change of all weights, of the budget, or of how many
        variables there are, changes both scales alike.
    """

    def __init__(self, max_iterations: int) -> None:
        """Take how many passes a frame may have."""
        self._max_iterations = max_iterations
        self.stand = 1.0

    def search(self, shares: Shares) -> Allocation:
        """Return the optimal shares, or after the last pass a feasible point, as `solve`.

        `low` is positive.
        """
        early = shares.settle()
        if early is not None:
            return early
        search = _Search(shares, self.stand)
        while not search.converged and search.iterations < self._max_iterations:
            search.step()
        if search.iterations > 1:  # else it is right, and would only gain rounding
            self.stand = search.scale / search.unbound
        comparisons = 2 * len(shares.cost) * search.iterations
        return Allocation(
            search.point(),
            search.scale**-shares.power,
            True,
            search.converged,
            search.iterations,
            comparisons,
        )


class _Search:
    """A working set, given by the scale at which its bounds hold, and what passes have shown.

    Attributes
    ----------
    scale : float
        ``λ^(-1/power)``.
    unbound : float
        The scale of the closed form where no bound is held.
    """

    def __init__(self, shares: Shares, stand: float) -> None:
        self._shares = shares
        self._unit = shares.unit()
        # What costs nothing, and so has an infinite unit, stands at `high` for good.
        if float(shares.cost.min()) > 0.0:
            self._paid = shares.cost * self._unit
        else:
            costs, nothing = shares.cost > 0.0, np.zeros(len(shares.cost))
            self._paid = np.multiply(shares.cost, self._unit, out=nothing, where=costs)
        # Finite: `settle` has dealt with frames in which nothing that costs has weight.
        self.unbound = shares.budget / float(self._paid.sum())
        self.scale = stand * self.unbound
        self._below, self._above = 0.0, math.inf
        self.iterations, self.converged = 0, False
        count = len(self._unit)
        self._wish, self._x = np.empty(count), np.empty(count)
        self._free = np.zeros(count, dtype=np.bool_)
        self._exchanged = False

    def step(self) -> None:
        """Make one pass: hold what breaks a bound, let go of what wants off one, look for more."""
        budget, scale = self._shares.budget, self.scale
        self.iterations += 1
        free, gap = self._hold()
        # Where the closed form meets the bounds that it was taken for, it is the optimum's.  A gap
        # of rounding is left as it is, so that repeated frames have the same x to the bit.
        same = self._exchanged and bool((free == self._free).all())
        if abs(gap) <= (_TOLERANCE if same else _ROUNDING) * budget:
            self.converged = True
            return
        wanted = float(self._paid @ free)
        # So it is where everything is held and the budget spent: no multiplier is negative there.
        if not wanted and abs(gap) <= _TOLERANCE * budget:
            self.converged = True
            return
        self._free = free
        # What is spent rises with the scale: the gap says on which side the optimum is.
        if gap > 0.0:
            self._below = scale
        else:
            self._above = scale
        # The closed form: what is free shares (budget - Σ_held) = gap + scale · wanted.
        following = scale + gap / wanted if wanted else scale
        self._exchanged = self._below < following < self._above
        if not self._exchanged and (not wanted or following != scale):
            following = halve(self._below, self._above)
        # No other double is left between the ends: the scale cannot be told more exactly.
        self.converged = following in {scale, self._below, self._above}
        if not self.converged:
            self.scale = following

    def _hold(self) -> tuple[BoolArray, float]:
        """Set x at the scale; return who is free there, (n,), and what the budget has left."""
        shares, x = self._shares, self._x
        wish = np.multiply(self._unit, self.scale, out=self._wish)
        np.minimum(np.maximum(wish, shares.low, out=x), shares.high, out=x)
        return x == wish, shares.budget - float(shares.cost @ x)

    def point(self) -> FloatArray:
        """Return the optimum, or where the budget ends on the way between the nearest points."""
        if self.converged:
            return self._x
        shares = self._shares
        within = self._at(self._below) if self._below else shares.low
        if self._above == math.inf:
            return within
        step = self._at(self._above) - within
        left = shares.budget - float(shares.cost @ within)
        point = within + left / float(shares.cost @ step) * step
        return np.minimum(point, shares.high, out=point)

    def _at(self, scale: float) -> FloatArray:
        return np.clip(scale * self._unit, self._shares.low, self._shares.high)
