"""The multiple-choice knapsack where many objects have one hull between them.

Where all costs of an object differ from its cheapest one as its class says, and its benefits are
its size times values of its class, the upper hull of `knapsack` is the same for all objects of a
class, and slopes are sizes times slopes of the class.  So hulls are made once, and from frame to
frame only sizes change.
"""

import math
from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from .column_counts import count_true
from .falling_cut import FallingCut
from .falling_prefix import falling_prefix
from .knapsack import hull_increments


class HullChoice(NamedTuple):
    """A selection.

    Attributes
    ----------
    column : (n,) int
    cost : float
        The sum of what its alternatives cost.
    """

    column: IntArray
    cost: float


class SharedHulls:
    """Hulls of C classes of objects."""

    def __init__(self, cost: FloatArray, value: FloatArray) -> None:
        """Take cost and value of alternatives for an object of size 1, (C, L).

        The cost of one that a class lacks is infinite.
        """
        self._cost, self._value = cost, value
        self._cheapest = cost.min(axis=1)
        self._more = cost - self._cheapest[:, None]
        self._most = float(self._more.max(initial=0.0, where=np.isfinite(cost)))
        self._whole = self._hulls = _hulls(cost, value)
        self._which = b""
        self._cut = FallingCut()

    def choose(
        self,
        kind: IntArray,
        size: FloatArray,
        budget: float,
        *,
        skip_misfits: bool,
        or_single: bool = False,
    ) -> HullChoice:
        """Return the greedy selection on the hulls, as `take_increments`.

        Classes and sizes of the objects are (n,).  Choices that no selection within the budget can
        hold are left out of the hulls, as in `affordable`.  With `or_single` the cheapest choices
        with the one change that gains most are returned where they are better, as in `best_single`.
        """
        hulls, left = self._afford(kind, budget)
        if left < 0.0 or not len(kind):
            return self._of(hulls.vertex[0].take(kind), kind)
        key = hulls.slope.take(kind, axis=1)
        key *= size
        cost = hulls.cost.take(kind, axis=1)
        taken, spent, first_left = self._cut.take(key.ravel(), cost.ravel(), left)
        taken = taken.reshape(key.shape)
        if skip_misfits and first_left >= 0:
            _go_on(key, cost, taken, left - spent)
        steps = count_true(taken)
        # Nothing that was left out can be better than all that was taken, if all was.
        if or_single and first_left >= 0:
            gain = hulls.single.take(kind)
            gain *= size
            best = int(gain.argmax())
            value = hulls.value.take(steps * len(self._cost) + kind)
            value *= size
            if gain[best] > float(value.sum()):
                column = hulls.vertex[0].take(kind)
                column[best] = hulls.single_column[kind[best]]
                return self._of(column, kind)
        return self._of(hulls.vertex.take(steps * len(self._cost) + kind), kind)

    def bound(self, kind: IntArray, size: FloatArray, budget: float) -> float:
        """Return the optimum of the linear relaxation, as `relaxed_bound`: no selection has more.

        Classes and sizes of the objects are (n,).
        """
        hulls = self._whole
        left = budget - float(self._cheapest.take(kind).sum())
        if left < 0.0:
            return -math.inf
        base = self._value[np.arange(len(self._value)), hulls.vertex[0]].take(kind)
        if not len(hulls.slope):
            return float(base @ size)
        key = hulls.slope.take(kind, axis=1)
        key *= size
        cost = hulls.cost.take(kind, axis=1)
        taken, spent, first_left = self._cut.take(key.ravel(), cost.ravel(), left)
        base += hulls.value.take(count_true(taken.reshape(key.shape)) * len(self._cost) + kind)
        bound = float(base @ size)
        if first_left >= 0:
            # The relaxation takes the first edge that does not fit in part (Dantzig).
            bound += (left - spent) * float(key.ravel()[first_left])
        return bound

    def _of(self, column: IntArray, kind: IntArray) -> HullChoice:
        # By their places in flat arrays: twice as fast as by two indices.
        at: IntArray = kind * self._cost.shape[1] + column
        cost = self._cost.take(at)
        return HullChoice(column, float(cost.sum()))

    def _afford(self, kind: IntArray, budget: float) -> tuple["_Hulls", float]:
        """Return hulls of what is affordable, and what is left beyond the cheapest choices."""
        left = budget - float(self._cheapest.take(kind).sum())
        if left >= self._most:
            return self._whole, left
        fits = (self._more <= left) | (self._more == 0.0)
        which = fits.tobytes()
        # The same choices usually stay affordable for many frames.
        if which != self._which:
            self._which = which
            self._hulls = _hulls(np.where(fits, self._cost, np.inf), self._value)
        return self._hulls, left


class _Hulls(NamedTuple):
    """Upper hulls of C classes, of up to E edges by falling slope; lacking edges have slope 0.

    Attributes
    ----------
    vertex : (E + 1, C) int
        Columns along each hull, the cheapest first.
    value : (E + 1, C) float64
        What they have more of than the cheapest.
    slope, cost : (E, C) float64
    single : (C,) float64
        The most that one change from the cheapest gains, and its column.
    single_column : (C,) int
    """

    vertex: IntArray
    value: FloatArray
    slope: FloatArray
    cost: FloatArray
    single: FloatArray
    single_column: IntArray


def _hulls(cost: FloatArray, value: FloatArray) -> _Hulls:
    increments = hull_increments(cost, value)
    count = len(cost)
    owner = increments.owner
    # By falling slope an increment's place on its hull is how many of its owner stand before it.
    grouped = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[grouped], np.arange(count))
    place = np.empty(len(owner), dtype=np.intp)
    place[grouped] = np.arange(len(owner)) - first[owner[grouped]]
    edges = int(place.max(initial=-1)) + 1
    vertex = np.tile(increments.base, (edges + 1, 1))
    slope, edge = np.zeros((edges, count)), np.zeros((edges, count))
    slope[place, owner] = increments.benefit / increments.cost
    edge[place, owner] = increments.cost
    vertex[place + 1, owner] = increments.column
    rows = np.arange(count)
    more = value - value[rows, increments.base][:, None]
    gain = np.where(np.isfinite(cost), more, -np.inf)
    return _Hulls(vertex, more[rows, vertex], slope, edge, gain.max(axis=1), gain.argmax(axis=1))


def _go_on(key: FloatArray, cost: FloatArray, taken: BoolArray, left: float) -> None:
    """Take, in place, what still fits behind misfits, whose objects' later edges are left out.

    Arrays are (E, n), by falling slope along the first axis.
    """
    dead = (cost > left) & ~taken
    np.logical_or.accumulate(dead, axis=0, out=dead)
    rest = ((key > 0.0) & ~(dead | taken)).ravel().nonzero()[0]
    slope, price, flat = key.ravel()[rest], cost.ravel()[rest], taken.ravel()
    while len(rest):
        order, total = falling_prefix(slope, price, left)
        count = int(np.searchsorted(total, left, side="right"))
        flat[rest[order[:count]]] = True
        if count == len(rest):
            break
        left -= float(total[count - 1]) if count else 0.0
        # Edges stand by their places along the hulls, so that a misfit is before those it hides.
        slope[order[:count]] = 0.0
        owner = rest % key.shape[1]
        misfit = (price > left) & (slope > 0.0)
        first = np.full(key.shape[1], len(rest))
        at = misfit.nonzero()[0]
        np.minimum.at(first, owner[at], at)
        keep = (slope > 0.0) & (np.arange(len(rest)) < first[owner])
        rest, slope, price = rest[keep], slope[keep], price[keep]
