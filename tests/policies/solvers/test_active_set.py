"""The active-set search: the optimum from anywhere, by few passes, and a feasible point at any."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import brentq

from lodbench.base.arrays import FloatArray
from lodbench.policies.solvers.active_set import ActiveSet
from lodbench.policies.solvers.allocation import Allocation, Shares, allocate

WEIGHT = np.array([400.0, 100.0, 25.0])
COST = np.array([20.0, 10.0, 5.0])
PLENTY = 100_000


def shares_of(
    weight: FloatArray, cost: FloatArray, budget: float, *, power: float, low: Any
) -> Shares:
    """Return a problem asked as `allocate` is; `high` is 1."""
    low, high = np.broadcast_to(low, len(cost)), np.ones(len(cost))
    return Shares(weight, cost, budget, power, low, high)


def allocate_by_active_set(
    weight: FloatArray, cost: FloatArray, budget: float, *, power: float, low: Any, **more: Any
) -> Allocation:
    """Return what a search finds, by default begun with no bound held and with passes enough."""
    search = ActiveSet(more.pop("max_iterations", PLENTY))
    search.stand = more.pop("stand", 1.0)
    return search.search(shares_of(weight, cost, budget, power=power, low=low))


def random_instance(seed: int, n: int) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Weights, costs and lower bounds, and a budget that leaves bounds of both kinds active."""
    rng = np.random.default_rng(seed)
    weight, cost = np.exp(rng.normal(0.0, 2.0, n)), np.exp(rng.normal(0.0, 1.0, n))
    low = rng.uniform(0.05, 0.3, n)
    floor = float(cost @ low)
    return weight, cost, low, floor + 0.4 * (float(cost.sum()) - floor)


@pytest.mark.parametrize(("budget", "passes"), [(5.0, 1), (20.0, 1), (30.0, 2)])
def test_by_hand(budget: float, passes: int) -> None:
    """Without a bound in the way one closed form is the answer; one blocked bound takes two."""
    result = allocate_by_active_set(WEIGHT, COST, budget, power=2.0, low=0.05)
    assert result.converged
    assert result.iterations == passes
    expected = {
        # Units sqrt(weight / cost) are (4.47, 3.16, 2.24), and cost times unit (89.4, 31.6, 11.2).
        5.0: 5.0
        / (89.4427191 + 31.6227766 + 11.1803399)
        * np.array([4.4721360, 3.1622777, 2.236068]),
        20.0: 20.0 / 132.2458356 * np.array([4.4721360, 3.1622777, 2.236068]),
        # The first is full, at 0.68 · 1.5 > 1: the others share what it leaves of the budget.
        30.0: np.array([1.0, *(10.0 / 42.8031165 * np.array([3.1622777, 2.236068]))]),
    }[budget]
    assert_allclose(result.x, expected, rtol=1e-7)


@pytest.mark.parametrize("budget", [1.0, 1.75, 35.0, 50.0])
def test_budgets_that_leave_no_choice(budget: float) -> None:
    """Infeasible, exactly feasible and full budgets give the bounds exactly."""
    result = allocate_by_active_set(WEIGHT, COST, budget, power=2.0, low=0.05, max_iterations=1)
    assert_array_equal(result.x, 1.0 if budget >= 35.0 else 0.05)
    assert result.feasible == (budget >= 1.75)
    assert result.converged


@pytest.mark.parametrize("stand", [0.02, 100.0], ids=["all at low", "all at high"])
def test_a_multiplier_that_turns_negative_leaves_the_set(stand: float) -> None:
    """Begun with every bound held on one side, no free variable tells where to go."""
    weight, cost = np.array([1.0, 100.0, 100.0]), np.ones(3)
    result = allocate_by_active_set(weight, cost, 1.05, power=2.0, low=0.01, stand=stand)
    assert_allclose(result.x, (0.05, 0.5, 0.5), rtol=1e-12)
    assert result.multiplier == pytest.approx(100.0 / 0.5**2, rel=1e-12)


def test_a_budget_spent_where_every_bound_is_held() -> None:
    """At a vertex any price between the two sides' proves the optimum; the search finds one."""
    weight, cost = np.array([100.0, 1e-4]), np.ones(2)
    result = allocate_by_active_set(weight, cost, 1.1, power=2.0, low=0.1)
    assert result.converged
    assert_allclose(result.x, (1.0, 0.1), rtol=1e-12)
    assert 1e-4 / 0.1**2 * (1.0 - 1e-9) <= result.multiplier <= 100.0 * (1.0 + 1e-9)


@settings(deadline=None, max_examples=200)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(1, 60),
    stand=st.floats(1e-3, 1e3),
    power=st.sampled_from((2.0, 3.0)),
    spread=st.sampled_from((1.0, 4.0)),
)
def test_the_optimum_from_anywhere(
    kkt_residual: Callable[..., float], seed: int, n: int, stand: float, power: float, spread: float
) -> None:
    """Newton's optimum, and the conditions of optimality, from any working set."""
    weight, cost, low, budget = random_instance(seed, n)
    weight **= spread
    args: dict[str, Any] = {"power": power, "low": low}
    found = allocate_by_active_set(weight, cost, budget, stand=stand, **args)
    assert found.converged
    assert kkt_residual(found, weight, cost, budget, **args, high=1.0) < 1e-9
    best = allocate(weight, cost, budget, **args, high=1.0)
    assert_allclose(found.x, best.x, rtol=1e-11)
    assert found.iterations < 40


def test_the_optimum_as_a_root_finder_has_it() -> None:
    """The price at which the budget is spent, by Brent's method, which knows no working set."""
    weight, cost, low, budget = random_instance(11, 500)

    def shares_at(log_price: float) -> FloatArray:
        return np.clip(np.cbrt(weight / (np.exp(log_price) * cost)), low, 1.0)

    log_price = brentq(lambda p: float(cost @ shares_at(p)) - budget, -30.0, 30.0, xtol=1e-14)
    found = allocate_by_active_set(weight, cost, budget, power=3.0, low=low)
    assert_allclose(found.x, shares_at(log_price), rtol=1e-12)
    assert np.log(found.multiplier) == pytest.approx(log_price, abs=1e-12)
    assert 0 < np.count_nonzero(found.x == low) < 500
    assert 0 < np.count_nonzero(found.x == 1.0) < 500


@pytest.mark.parametrize("stand", [1.0, 0.01, 100.0])
@pytest.mark.parametrize("seed", range(8))
def test_stops_anywhere_within_bounds_and_budget(stand: float, seed: int) -> None:
    """After any number of passes the point is feasible, and never worse than the lowest."""
    weight, cost, low, budget = random_instance(seed, 200)
    args: dict[str, Any] = {"power": 2.0, "low": low, "stand": stand}
    degradation: list[float] = []
    converged, passes = False, 0
    while not converged:
        passes += 1
        result = allocate_by_active_set(weight, cost, budget, max_iterations=passes, **args)
        converged = result.converged
        assert result.iterations == passes
        assert float(cost @ result.x) <= budget * (1.0 + 1e-12)
        assert (result.x >= low).all()
        assert (result.x <= 1.0).all()
        degradation.append(float((weight / result.x).sum()))
    best = float((weight / allocate(weight, cost, budget, power=2.0, low=low, high=1.0).x).sum())
    assert degradation[-1] == pytest.approx(best, rel=1e-12)
    assert max(degradation) <= float((weight / low).sum())
    assert len(degradation) > 2


def test_a_frame_begins_where_the_last_one_ended() -> None:
    """After a frame that differs little, fewer passes; after one only scaled, the first is it."""
    weight, cost, low, budget = random_instance(4, 1000)
    cold = ActiveSet(PLENTY)
    moved = weight * np.exp(np.random.default_rng(5).normal(0.0, 0.002, 1000))
    first = cold.search(shares_of(weight, cost, budget, power=2.0, low=low))
    warm = cold.search(shares_of(moved, cost, 0.999 * budget, power=2.0, low=low))
    assert warm.iterations <= 3 < first.iterations
    best = allocate(moved, cost, 0.999 * budget, power=2.0, low=low, high=1.0)
    assert_allclose(warm.x, best.x, rtol=1e-12)
    scaled = cold.search(shares_of(7.0 * moved, cost, 0.999 * budget, power=2.0, low=low))
    assert scaled.iterations <= 2
    assert_allclose(scaled.x, warm.x, rtol=1e-12)


def test_a_repeated_frame_is_the_same_to_the_bit() -> None:
    """Rounding would have a simulator charge for levels that a camera at rest changes."""
    weight, cost, low, budget = random_instance(9, 1000)
    search = ActiveSet(PLENTY)
    shares = shares_of(weight, cost, budget, power=2.0, low=low)
    first, second, third, fourth = (search.search(shares) for _ in range(4))
    assert_allclose(second.x, first.x, rtol=1e-14)
    assert_array_equal(third.x, second.x)
    assert_array_equal(fourth.x, second.x)
    assert (third.iterations, fourth.iterations) == (1, 1)


def test_a_frame_without_a_choice_does_not_move_the_start() -> None:
    """What is begun with outlives a frame in which everything fits."""
    weight, cost, low, budget = random_instance(6, 1000)
    search = ActiveSet(PLENTY)
    search.search(shares_of(weight, cost, budget, power=3.0, low=low))
    search.search(shares_of(weight, cost, 2.0 * float(cost.sum()), power=3.0, low=low))
    again = search.search(shares_of(weight, cost, budget, power=3.0, low=low))
    assert again.iterations <= 2


def test_free_and_worthless_objects() -> None:
    """What costs nothing is full and what weighs nothing is lowest, as Newton has it."""
    weight, cost = np.array([1.0, 0.0, 4.0, 1.0]), np.array([0.0, 1.0, 1.0, 1.0])
    result = allocate_by_active_set(weight, cost, 0.85, power=2.0, low=0.1)
    assert_allclose(result.x, (1.0, 0.1, 0.5, 0.25), rtol=1e-14)
