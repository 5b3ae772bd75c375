"""The greedy cut and the greedy prefix, compared with sorting everything."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.column_counts import count_true
from lodbench.policies.solvers.falling_cut import FallingCut
from lodbench.policies.solvers.falling_prefix import falling_prefix


def sorted_cut(key: np.ndarray, cost: np.ndarray, budget: float) -> tuple[np.ndarray, int]:
    """Return what is taken one at a time by falling key, and the first that does not fit."""
    taken, left = np.zeros(len(key), dtype=bool), budget
    for item in np.argsort(-key, kind="stable").tolist():
        if key[item] <= 0.0:
            break
        if cost[item] > left:
            return taken, item
        taken[item], left = True, left - cost[item]
    return taken, -1


@given(seed=st.integers(0, 10_000), n=st.integers(1, 300), spread=st.floats(0.0, 6.0))
def test_a_cut_equals_one_by_sorting_from_frame_to_frame(seed: int, n: int, spread: float) -> None:
    """Whole numbers add up exactly; keys tie, vanish, drift and jump, budgets too."""
    rng = np.random.default_rng(seed)
    key = np.round(np.exp(spread * rng.normal(size=n)), 1)
    cost = rng.integers(0, 9, n).astype(float)
    cut = FallingCut()
    for factor in (0.5, 0.51, 0.49, 0.0, 2.0, 0.9, 1e-3, 1.0, 0.3):
        key = key * rng.choice([0.97, 1.0, 1.03, 1e4, 1e-4])
        budget = float(np.floor(factor * cost.sum()))
        got, (taken, first_left) = cut.take(key, cost, budget), sorted_cut(key, cost, budget)
        assert got.taken.tolist() == taken.tolist()
        assert got.first_left == first_left
        assert got.spent == cost[taken].sum()


def test_nothing_positive_is_all_there_is() -> None:
    """Keys of zero and below are no items, whatever the budget."""
    got = FallingCut().take(np.array([0.0, -1.0]), np.array([1.0, 0.0]), 5.0)
    assert (got.taken.any(), got.spent, got.first_left) == (False, 0.0, -1)


@given(seed=st.integers(0, 10_000), n=st.integers(0, 2000))
def test_a_prefix_is_the_beginning_of_the_whole_order(seed: int, n: int) -> None:
    """Equal keys keep their order, and the sums exceed the limit or everything is there."""
    rng = np.random.default_rng(seed)
    key, amount = rng.integers(0, 40, n).astype(float), rng.integers(0, 5, n).astype(float)
    limit = float(rng.integers(0, 1 + int(amount.sum())))
    order, total = falling_prefix(key, amount, limit)
    assert order.tolist() == np.argsort(-key, kind="stable")[: len(order)].tolist()
    assert total.tolist() == np.cumsum(amount[order]).tolist()
    assert len(order) == n or total[-1] > limit


@pytest.mark.parametrize("rows", [0, 1, 255, 300])
def test_truth_values_are_counted_beyond_a_byte(rows: int) -> None:
    """A column of 300 true ones counts 300, where bytes alone would say 44."""
    mask = np.ones((rows, 3), dtype=bool)
    mask[:, 1] = False
    assert count_true(mask).tolist() == [rows, 0, rows]
