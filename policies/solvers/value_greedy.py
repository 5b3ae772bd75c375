"""Funkhouser and Séquin's two algorithms for one level an object within a budget, as printed.

This work is based on: Funkhouser and Séquin, "Adaptive display algorithm for interactive frame
rates during visualization of complex virtual environments", SIGGRAPH 1993, section 5, as the HLOD
thesis (chapter 5) and the project's notes restate it.  Both are written in bulk: where the paper
takes one step after another in a known order, all steps up to the first that does not fit are taken
at once, with the same result.
"""

import numpy as np

from ...base.arrays import FloatArray, IntArray


def greedy_by_value(
    cost: FloatArray, benefit: FloatArray, budget: float, start: IntArray
) -> IntArray:
    """Return a column for each of n objects (-1: not drawn), choosing by falling value.

    Tuples are visited by falling ``benefit / cost``; one is taken, in place of the object's earlier
    one, if it has more benefit and the sum still fits.  Pure ratio order has no constant bound:
    of (0.02, cost 1) and (1, cost 100) it takes the first within 100.

    Parameters
    ----------
    cost, benefit : (n, L) float64
        Rising together along each row's finite alternatives; cost infinite where there is none.
    budget : float
    start : (n,) int
        Columns chosen beforehand, -1 for none; they stay if nothing better fits.
    """
    n, width = cost.shape
    column = start.copy()
    chosen_cost = _of(cost, column)
    chosen_benefit = _of(benefit, column)
    left = budget - float(chosen_cost.sum())
    value = np.divide(benefit, cost, out=np.zeros((n, width)), where=np.isfinite(cost) & (cost > 0))
    rest: IntArray = np.argsort(-value, axis=None, kind="stable")
    rest = rest[np.isfinite(cost.ravel()[rest])]
    while len(rest):
        owner = rest // width
        # What does not fit now never will: an exchange on another object only takes room, and one
        # on the same object takes as much room as it makes its later exchanges cheaper.
        better = benefit.ravel()[rest] > chosen_benefit[owner]
        fits = cost.ravel()[rest] - chosen_cost[owner] <= left
        rest = rest[better & fits]
        count, step = _accept(cost, benefit, chosen_cost, rest, left)
        taken = rest[step[:count]]
        column[taken // width] = taken % width  # the last write is the tuple taken last
        chosen_cost, chosen_benefit = _of(cost, column), _of(benefit, column)
        left = budget - float(chosen_cost.sum())
        if count == len(step):
            break
        # As printed, the pass goes on behind the tuple that does not fit.
        rest = rest[step[count] + 1 :]
    return column


def _of(values: FloatArray, column: IntArray) -> FloatArray:
    """Return each row's value in its column, 0 where the column is -1."""
    rows = np.arange(len(column))
    return np.where(column >= 0, values[rows, np.maximum(column, 0)], 0.0)


def _accept(
    cost: FloatArray, benefit: FloatArray, chosen_cost: FloatArray, rest: IntArray, left: float
) -> tuple[int, IntArray]:
    """Return which of `rest` improve on those before them, and how many of these fit in order."""
    width = cost.shape[1]
    owner = rest // width
    # One row an object, its tuples in the order of the pass: which of them improve on those before
    # is then a running maximum along the row, for all objects at once.
    grouped = np.argsort(owner, kind="stable")
    count = np.bincount(owner, minlength=len(cost))
    first = np.cumsum(count) - count
    rank = np.arange(len(rest)) - first[owner[grouped]]
    table = np.full((len(cost), width), -np.inf)
    table[owner[grouped], rank] = benefit.ravel()[rest[grouped]]
    best = np.maximum.accumulate(table, axis=1)
    rises = np.ones_like(table, dtype=np.bool_)
    rises[:, 1:] = table[:, 1:] > best[:, :-1]
    prices = np.zeros_like(table)
    prices[owner[grouped], rank] = cost.ravel()[rest[grouped]]
    position = np.where(rises, np.arange(width, dtype=np.int32), np.int32(0))
    last = np.maximum.accumulate(position, axis=1)
    # What each tuple replaces: the last before it that improved, else what was chosen already.
    before = np.column_stack((chosen_cost, np.take_along_axis(prices, last, axis=1)[:, :-1]))
    accepted = np.zeros(len(rest), dtype=np.bool_)
    accepted[grouped] = rises[owner[grouped], rank]
    more = np.zeros(len(rest))
    more[grouped] = (prices - before)[owner[grouped], rank]
    step: IntArray = np.flatnonzero(accepted)
    over = np.cumsum(more[step]) > left
    return (int(over.argmax()) if over.any() else len(step)), step


def improve_incrementally(
    cost: FloatArray, benefit: FloatArray, budget: float, start: IntArray, max_steps: int
) -> tuple[IntArray, int]:
    """Return improved columns and the number of steps, starting from the last frame's columns.

    Raise the object that gains most benefit per cost; while the sum is over the budget, lower the
    one that loses least; stop when the level just raised is the one to be lowered, or after
    `max_steps` such exchanges.  Column 0 is the finest.
    """
    column = start.copy()
    over = float(_of(cost, column).sum()) - budget
    steps = _walk(cost, benefit, column, 1, over) if over > 0.0 else 0
    steps += _walk(cost, benefit, column, -1, budget - float(_of(cost, column).sum()))
    for _ in range(max_steps):
        up = _slopes(cost, benefit, column, -1)
        best = int(up.argmax())
        if up[best] <= 0.0:
            break
        before = column.copy()
        column[best] -= 1
        steps += 1
        same = False
        while float(_of(cost, column).sum()) > budget and not same:
            down = _slopes(cost, benefit, column, 1)
            least = int(down.argmin())
            if not np.isfinite(down[least]):
                break
            # The paper's end: the step down would undo the step up that was just made.
            same = least == best and column[least] + 1 == before[least]
            column[least] += 1
            steps += 1
        # The exchange brought nothing, or could not be paid for.
        if same or float(_of(cost, column).sum()) > budget:
            return before, steps
    return column, steps


def _slopes(cost: FloatArray, benefit: FloatArray, column: IntArray, step: int) -> FloatArray:
    """Return benefit gained (up) or lost (down) per cost of moving each object one level.

    Where there is no such level it is -inf (up) or inf (down).
    """
    rows = np.arange(len(column))
    to = column + step
    exists = (to >= 0) & (to < cost.shape[1])
    to = np.where(exists, to, column)
    exists &= np.isfinite(cost[rows, to])
    more_cost = np.abs(np.where(exists, cost[rows, to] - cost[rows, column], 1.0))
    more_benefit = -step * (benefit[rows, to] - benefit[rows, column])
    slope = more_benefit / np.maximum(more_cost, 1e-300)
    return np.where(exists, slope, np.inf if step > 0 else -np.inf)


def _walk(cost: FloatArray, benefit: FloatArray, column: IntArray, step: int, amount: float) -> int:
    """Take steps of all objects, in place, in the order in which one at a time would be taken.

    Raising (-1) goes by falling slope up to the first step that does not fit in `amount`, lowering
    (1) by rising slope until that much is saved.

    One at a time always takes the best of the objects' next steps, so that a good step behind a
    poor one waits for it: steps go by the running minimum (raising) or maximum (lowering) of
    slopes along their object.
    """
    steps: list[tuple[IntArray, FloatArray, FloatArray]] = []
    at = column.copy()
    key = np.full(len(column), np.inf if step < 0 else -np.inf)
    while True:
        slope = _slopes(cost, benefit, at, step)
        # Nothing is raised for no gain, but anything may be lowered to fit.
        moving: IntArray = np.flatnonzero(np.isfinite(slope) & ((slope > 0.0) | (step > 0)))
        if not len(moving):
            break
        limit = np.minimum if step < 0 else np.maximum
        # Running minimum or maximum along the object: no later step stands before an earlier one.
        key[moving] = limit(key[moving], slope[moving])
        price = cost[moving, at[moving] + step] - cost[moving, at[moving]]
        steps.append((moving, key[moving], np.abs(price)))
        at[moving] += step
    if not steps:
        return 0
    owner, keys, price = (np.concatenate(part) for part in zip(*steps, strict=True))
    # Stable, and rounds are in sequence: of equal keys an object's earlier step stands first.
    order = np.argsort(step * keys, kind="stable")
    total = np.cumsum(price[order])
    # Raising ends before the step that does not fit, lowering with the one that makes it fit.
    side = "right" if step < 0 else "left"
    count = int(np.searchsorted(total, amount, side=side)) + (step > 0)
    moved = np.bincount(owner[order[:count]], minlength=len(column))
    column += step * moved
    return min(count, len(order))
