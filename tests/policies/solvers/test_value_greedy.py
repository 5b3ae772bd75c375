"""Funkhouser and Séquin's algorithms in bulk, compared with one step at a time."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from lodbench.policies.solvers.value_greedy import greedy_by_value, improve_incrementally

Table = NDArray[np.float64]


@st.composite
def chains(draw: st.DrawFn) -> tuple[Table, Table, float]:
    """Draw objects whose levels, finest first, fall in cost and benefit; some have fewer."""
    # Drawn by a generator, so that no two slopes tie: among equals either order is right.
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, width = draw(st.integers(1, 6)), draw(st.integers(1, 4))
    cost = np.cumsum(rng.uniform(0.01, 10.0, (n, width)), axis=1)[:, ::-1].copy()
    benefit = np.cumsum(rng.uniform(0.01, 10.0, (n, width)), axis=1)[:, ::-1].copy()
    for row in range(n):
        lacking = draw(st.integers(0, width - 1))
        cost[row, width - lacking :] = np.inf
        benefit[row, width - lacking :] = 0.0
    real = np.isfinite(cost)
    low = np.where(real, cost, np.inf).min(axis=1).sum()
    high = np.where(real, cost, 0.0).max(axis=1).sum()
    return cost, benefit, float(draw(st.floats(0.5 * low, 1.1 * high)))


def greedy_stepwise(cost: Table, benefit: Table, budget: float, start: list[int]) -> list[int]:
    """Visit tuples one by one by falling value, as the paper says."""
    column, width = list(start), cost.shape[1]

    def chosen(table: Table, row: int) -> float:
        return float(table[row, column[row]]) if column[row] >= 0 else 0.0

    spent = sum(chosen(cost, row) for row in range(len(cost)))
    value = np.where(np.isfinite(cost), benefit / cost, 0.0)
    for tuple_index in np.argsort(-value, axis=None, kind="stable"):
        row, to = divmod(int(tuple_index), width)
        more = float(cost[row, to]) - chosen(cost, row)
        if benefit[row, to] > chosen(benefit, row) and spent + more <= budget + 1e-12:
            spent += more
            column[row] = to
    return column


def slope(cost: Table, benefit: Table, row: int, at: int, to: int) -> float | None:
    """Return benefit per cost between two levels of an object, None where there is no level."""
    if not 0 <= to < cost.shape[1] or not np.isfinite(cost[row, to]):
        return None
    return float((benefit[row, to] - benefit[row, at]) / (cost[row, to] - cost[row, at]))


def incremental_stepwise(cost: Table, benefit: Table, budget: float, start: list[int]) -> list[int]:
    """Lower the least slope until the sum fits, then raise the best until one does not."""
    column = list(start)
    rows = range(len(cost))

    def spent() -> float:
        return float(sum(cost[row, column[row]] for row in rows))

    def moves(step: int) -> list[tuple[float, int]]:
        found = [(slope(cost, benefit, r, column[r], column[r] + step), r) for r in rows]
        return [(value, row) for value, row in found if value is not None]

    while spent() > budget and moves(1):
        column[min(moves(1))[1]] += 1
    while moves(-1):
        best = max(value for value, _ in moves(-1))
        row = next(r for value, r in moves(-1) if value == best)
        if spent() + cost[row, column[row] - 1] - cost[row, column[row]] > budget:
            break
        column[row] -= 1
    return column


@given(chains())
def test_greedy_in_bulk_equals_one_tuple_at_a_time(instance: tuple[Table, Table, float]) -> None:
    """From nothing and from the coarsest levels the benefit is that of the stepwise loop."""
    cost, benefit, budget = instance
    for start in (np.full(len(cost), -1), np.isfinite(cost).sum(axis=1) - 1):
        found = greedy_by_value(cost, benefit, budget, start)
        expected = greedy_stepwise(cost, benefit, budget, start.tolist())
        assert found.tolist() == expected


@given(chains(), st.data())
def test_increments_in_bulk_equal_one_at_a_time(
    instance: tuple[Table, Table, float], data: st.DataObject
) -> None:
    """Without exchanges the incremental form is the stepwise loop, from any last frame."""
    cost, benefit, budget = instance
    levels = np.isfinite(cost).sum(axis=1)
    start = np.array([data.draw(st.integers(0, int(count) - 1)) for count in levels])
    found, _ = improve_incrementally(cost, benefit, budget, start, 0)
    assert found.tolist() == incremental_stepwise(cost, benefit, budget, start.tolist())


@given(chains(), st.data())
def test_exchanges_keep_the_budget_and_stop(
    instance: tuple[Table, Table, float], data: st.DataObject
) -> None:
    """Exchanges never leave the sum over a budget that the coarsest levels meet."""
    cost, benefit, budget = instance
    levels = np.isfinite(cost).sum(axis=1)
    start = np.array([data.draw(st.integers(0, int(count) - 1)) for count in levels])
    found, steps = improve_incrementally(cost, benefit, budget, start, 64)
    rows = np.arange(len(cost))
    coarsest = float(cost[rows, levels - 1].sum())
    assert cost[rows, found].sum() <= max(budget, coarsest) + 1e-9
    assert steps >= 0


def test_ratio_order_takes_the_cheap_item_and_misses_the_good_one() -> None:
    """The paper's order takes benefit 0.02 within a budget that would have bought 1."""
    cost, benefit = np.array([[1.0], [100.0]]), np.array([[0.02], [1.0]])
    assert greedy_by_value(cost, benefit, 100.0, np.array([-1, -1])).tolist() == [0, -1]
