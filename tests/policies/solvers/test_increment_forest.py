"""Increments in bulk, compared with one at a time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.increment_forest import IncrementForest


def random_forest(seed: int, rows: int, columns: int) -> tuple[np.ndarray, ...]:
    """Return cost, gain, void, above and layers of a forest of up to three layers."""
    rng = np.random.default_rng(seed)
    cost = np.round(rng.uniform(-0.5, 4.0, (rows, columns)), 2)
    gain = np.round(rng.normal(2.0, 2.0, (rows, columns)), 2)
    void = rng.random((rows, columns)) < 0.2
    ends = np.unique(np.concatenate(([0, rows], rng.integers(1, rows + 1, 2))))
    above = np.full(rows, -1)
    for before, start, stop in zip(ends[:-2], ends[1:-1], ends[2:], strict=True):
        above[start:stop] = rng.integers(before - 1, start, stop - start)
        above[start:stop][above[start:stop] < before] = -1
    return cost, gain, void, above, ends


def one_at_a_time(
    cost: np.ndarray, gain: np.ndarray, void: np.ndarray, above: np.ndarray, budget: float
) -> np.ndarray:
    """Take the possible increment of the greatest slope that fits, again and again."""
    rows = len(cost)
    done = void.copy()
    taken = np.zeros_like(void)
    while True:
        best, where = 0.0, None
        for row in range(rows):
            path = row
            while above[path] >= 0 and done[above[path]].all():
                path = above[path]
            if above[path] >= 0 or done[row].all():
                continue
            column = int(np.argmin(done[row]))
            price = cost[row, column]
            slope = math.inf if price <= 0.0 else gain[row, column] / price
            if gain[row, column] > 0.0 and price <= budget and slope > best:
                best, where = slope, (row, column)
        if where is None:
            return taken
        taken[where] = done[where] = True
        budget -= cost[where]


def check_against_one_at_a_time(
    cost: np.ndarray, gain: np.ndarray, void: np.ndarray, above: np.ndarray, layers: np.ndarray
) -> None:
    """Compare what is taken within several budgets, in portions."""
    for budget in (0.0, 1.0, 3.0, 8.0, 30.0):
        expected = one_at_a_time(cost, gain, void, above, budget)
        forest = IncrementForest(cost, gain, void, above, layers)
        left = budget
        while (slope := forest.slope(left)) > 0.0:
            left -= forest.take(0.5 * slope, left)
        assert (forest.taken == expected).all()
        assert left == pytest.approx(budget - float(cost[expected].sum()), abs=1e-9)
        assert left >= -1e-12


@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 9), columns=st.integers(1, 4))
def test_bulk_takes_of_chains_what_one_at_a_time_would(seed: int, rows: int, columns: int) -> None:
    """Slopes rise and fall along a chain; what does not fit is passed over with all behind it."""
    cost, gain, void, _, _ = random_forest(seed, rows, columns)
    cost = np.abs(cost) + np.random.default_rng(seed).uniform(0.01, 0.02, cost.shape)  # no ties
    check_against_one_at_a_time(cost, gain, void, np.full(rows, -1), np.array([0, rows]))


@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 9), columns=st.integers(1, 4))
def test_bulk_takes_of_trees_what_one_at_a_time_would(seed: int, rows: int, columns: int) -> None:
    """Slopes fall down the tree, as they do where refinements pay less and less."""
    cost, _, void, above, layers = random_forest(seed, rows, columns)
    rng = np.random.default_rng(seed)
    cost = np.abs(cost) + rng.uniform(0.01, 0.02, cost.shape)  # no ties
    slope = rng.uniform(0.5, 0.99, cost.shape)
    for row in range(rows):
        slope[row, 0] *= slope[above[row], -1] if above[row] >= 0 else 5.0
        slope[row] = np.cumprod(slope[row])
    check_against_one_at_a_time(cost, slope * cost, void, above, layers)


def test_a_good_increment_waits_for_the_poor_one_before_it() -> None:
    """Row 0: slopes 1 and 9; row 1: slope 2.  Row 1 comes first, then row 0's two together."""
    cost = np.array([[1.0, 1.0], [1.0, 0.0]])
    gain = np.array([[1.0, 9.0], [2.0, 0.0]])
    void = np.array([[False, False], [False, True]])
    forest = IncrementForest(cost, gain, void, np.array([-1, -1]), np.array([0, 2]))
    assert forest.slope(10.0) == 2.0
    assert forest.take(1.5, 10.0) == 1.0
    assert forest.taken.tolist() == [[False, False], [True, False]]
    assert forest.slope(9.0) == 1.0
    assert forest.take(1.0, 9.0) == 2.0
    assert forest.slope(7.0) == 0.0


def test_children_need_their_parent() -> None:
    """Row 1 stands below row 0, whose increment does not fit: nothing is taken, though 1 fits."""
    cost, gain = np.array([[5.0], [1.0]]), np.array([[1.0], [100.0]])
    void = np.zeros((2, 1), dtype=bool)
    forest = IncrementForest(cost, gain, void, np.array([-1, 0]), np.array([0, 1, 2]))
    assert forest.slope(4.0) == 0.0
    assert not forest.taken.any()


def test_what_gains_at_no_cost_comes_first() -> None:
    """An increment that saves time and gains has an infinite slope; one that only saves is none."""
    cost, gain = np.array([[-1.0], [-1.0], [0.0]]), np.array([[1.0], [-1.0], [1.0]])
    void = np.zeros((3, 1), dtype=bool)
    forest = IncrementForest(cost, gain, void, np.full(3, -1), np.array([0, 3]))
    assert forest.slope(0.0) == math.inf
    assert forest.take(math.inf, 0.0) == -1.0
    assert forest.taken.ravel().tolist() == [True, False, True]


def test_ahead_looks_as_far_as_half_of_what_is_left() -> None:
    """Of costs 1, 1, 1, 1 with 5 left two fit in half; with 1.5 left only the next counts."""
    cost = np.ones((4, 1))
    gain = np.array([[4.0], [3.0], [2.0], [1.0]])
    void = np.zeros((4, 1), dtype=bool)
    forest = IncrementForest(cost, gain, void, np.full(4, -1), np.array([0, 4]))
    assert forest.ahead(5.0) == (3.0, 2.5)
    assert forest.ahead(1.5) == (4.0, 1.5)


def test_no_rows_offer_nothing() -> None:
    """A scene without discrete nodes has no increment."""
    nothing = np.zeros((0, 1))
    forest = IncrementForest(nothing, nothing, nothing > 0.0, np.zeros(0, dtype=int), np.array([0]))
    assert forest.slope(1.0) == 0.0
    assert forest.ahead(1.0) == (0.0, 1.0)
