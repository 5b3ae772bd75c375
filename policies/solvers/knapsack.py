"""The multiple-choice knapsack of level selection: one level an object within a budget.

An object's levels are points (cost, benefit), of which only the vertices of the upper concave hull
matter to the linear relaxation (Sinha and Zoltners, "The multiple-choice knapsack problem",
Operations Research 27, 1979).  The hull's edges are increments of falling slope; taking increments
of all objects in order of slope until one does not fit solves the relaxation but for that one's
fraction, so one pass yields a selection and a certified bound.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Increments:
    """Edges of all objects' upper hulls, by falling slope; k of them.

    Attributes
    ----------
    base : (n,) int
        Column of each object's first hull vertex: its cheapest choice.
    owner : (k,) int
    column : (k,) int
        Column that the increment leads to.
    cost, benefit : (k,) float64
        What the increment adds; both positive.
    base_cost, base_benefit : float
        Sums over the base choices.
    """

    base: IntArray
    owner: IntArray
    column: IntArray
    cost: FloatArray
    benefit: FloatArray
    base_cost: float
    base_benefit: float


@dataclass(frozen=True, slots=True)
class Choice:
    """A selection.

    Attributes
    ----------
    column : (n,) int, chosen for each object
    cost, benefit : float, their sums
    """

    column: IntArray
    cost: float
    benefit: float


def affordable(cost: FloatArray, budget: float) -> FloatArray:
    """Return costs without the choices that no selection within the budget can hold.

    These are the ones that do not fit even with every other object at its cheapest.  They must go
    before the hull is built: a vertex that can never be taken hides those below the edge to it, and
    the greedy pass loses its bound of one half.
    """
    cheapest = cost.min(axis=1, keepdims=True)
    # What a single object may spend on top of its cheapest choice, all others at theirs.
    left = budget - float(cheapest.sum())
    return np.where((cost - cheapest <= left) | (cost == cheapest), cost, np.inf)


def hull_increments(cost: FloatArray, benefit: FloatArray) -> Increments:
    """Return the increments of n objects with up to L choices each.

    `cost` and `benefit` are (n, L); a choice that an object lacks has an infinite cost.  The base
    is the cheapest choice, of several the most beneficial.
    """
    n, choices = cost.shape
    cheapest = cost.min(axis=1, keepdims=True)
    base: IntArray = np.where(cost == cheapest, benefit, -np.inf).argmax(axis=1)
    rows: IntArray = np.arange(n, dtype=np.int32)
    # One vertex of every hull a round, gift wrapping: L - 1 rounds of whole arrays at most.
    edges: list[tuple[IntArray, IntArray, IntArray]] = [(rows[:0], base[:0], base[:0])]
    owner, column = rows, base
    for _ in range(choices - 1):
        edge = _steepest(cost, benefit, owner, column)
        owner, _, column = edge
        if not len(owner):
            break
        edges.append(edge)
    owner, before, column = (np.concatenate(part) for part in zip(*edges, strict=True))
    more_cost = cost[owner, column] - cost[owner, before]
    more_benefit = benefit[owner, column] - benefit[owner, before]
    # Stable: increments of one object with rounding-equal slopes stay in order.
    order = np.argsort(-more_benefit / more_cost, kind="stable")
    return Increments(
        base,
        owner[order],
        column[order],
        more_cost[order],
        more_benefit[order],
        float(cost[rows, base].sum()),
        float(benefit[rows, base].sum()),
    )


def _steepest(
    cost: FloatArray, benefit: FloatArray, owner: IntArray, column: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Return the owners that have a next hull vertex, their columns and those it is at."""
    more_cost = cost[owner] - cost[owner, column][:, None]
    more_benefit = benefit[owner] - benefit[owner, column][:, None]
    # The hull is followed on its rising part only: dearer without being better is dominated.
    better = (more_cost > 0.0) & (more_benefit > 0.0) & np.isfinite(more_cost)
    slope = np.divide(more_benefit, more_cost, out=np.full_like(more_cost, -1.0), where=better)
    steepest = slope.max(axis=1, keepdims=True)
    # Of equally steep vertices the farthest: the others lie on the same edge.
    to: IntArray = np.where(better & (slope == steepest), more_cost, -1.0).argmax(axis=1)
    going = steepest[:, 0] > 0.0
    return owner[going], column[going], to[going]


def take_increments(increments: Increments, budget: float, *, skip_misfits: bool) -> Choice:
    """Return the greedy selection: increments by falling slope while they fit the budget.

    With `skip_misfits` the pass goes on behind an increment that does not fit, leaving out the
    later increments of its object.  If the base does not fit, the base is returned.
    """
    column = increments.base.copy()
    left = budget - increments.base_cost
    taken = np.zeros(len(increments.owner), dtype=np.bool_)
    rest: IntArray = np.arange(len(increments.owner))
    # Slopes fall along a hull, so the order by slope keeps each object's increments in sequence.
    while left >= 0.0 and len(rest):
        total = np.cumsum(increments.cost[rest])
        # `right`, because a sum that equals what is left still fits.
        count = int(np.searchsorted(total, left, side="right"))
        taken[rest[:count]] = True
        if count == len(rest) or not skip_misfits:
            break
        left -= float(total[count - 1]) if count else 0.0
        rest = _still_possible(increments, rest[count:], left)
    order = np.flatnonzero(taken)
    column[increments.owner[order]] = increments.column[order]  # the last write is the finest
    cost = increments.base_cost + float(increments.cost[taken].sum())
    benefit = increments.base_benefit + float(increments.benefit[taken].sum())
    return Choice(column, cost, benefit)


def _still_possible(increments: Increments, rest: IntArray, left: float) -> IntArray:
    """Drop increments that do not fit any more, and those behind them on the same object."""
    misfit = increments.cost[rest] > left
    # Place of each object's first misfit; from there on none of its increments can be taken.
    first = np.full(len(increments.base), len(rest))
    np.minimum.at(first, increments.owner[rest[misfit]], np.flatnonzero(misfit))
    return rest[np.arange(len(rest)) < first[increments.owner[rest]]]


def best_single(
    cost: FloatArray, benefit: FloatArray, increments: Increments, budget: float
) -> tuple[IntArray, float]:
    """Return columns and benefit of the base with the one change that fits and gains most.

    Of `affordable` choices the better of this and `take_increments` has at least half of the
    optimum's gain over the base: what the pass took and the increment that did not fit, which would
    fit alone, together exceed the relaxation's gain.
    """
    rows = np.arange(len(increments.base))
    more_cost = cost - cost[rows, increments.base][:, None]
    gain = benefit - benefit[rows, increments.base][:, None]
    gain = np.where(more_cost <= budget - increments.base_cost, gain, -np.inf)
    best = int(gain.argmax())
    owner, to = divmod(best, cost.shape[1])
    column = increments.base.copy()
    if gain[owner, to] <= 0.0:
        return column, increments.base_benefit
    column[owner] = to
    return column, increments.base_benefit + float(gain[owner, to])


def relaxed_bound(increments: Increments, budget: float) -> float:
    """Return the optimum of the linear relaxation: no selection within the budget has more.

    If the base does not fit, minus infinity: there is no selection.
    """
    left = budget - increments.base_cost
    if left < 0.0:
        return -np.inf
    total = np.cumsum(increments.cost)
    count = int(np.searchsorted(total, left, side="right"))
    bound = increments.base_benefit + float(increments.benefit[:count].sum())
    if count < len(total):
        # The relaxation's optimum takes the first increment that does not fit in part (Dantzig).
        rest = left - (float(total[count - 1]) if count else 0.0)
        bound += rest * float(increments.benefit[count] / increments.cost[count])
    return bound
