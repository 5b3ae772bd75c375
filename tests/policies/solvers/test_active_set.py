"""The active-set search: agrees with Newton, may stop anywhere, starts anywhere."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.arrays import FloatArray
from lodbench.policies.solvers.active_set import search_active_set
from lodbench.policies.solvers.allocation import Allocation, Shares, allocate

WEIGHT = np.array([400.0, 100.0, 25.0])
COST = np.array([20.0, 10.0, 5.0])
PLENTY = 100_000


def allocate_by_active_set(
    weight: FloatArray, cost: FloatArray, budget: float, *, power: float, low: Any, **more: Any
) -> Allocation:
    """Return what the search finds, asked as `allocate` is; `high` is 1 unless given."""
    low, high = np.broadcast_to(low, len(cost)), np.full(len(cost), more.pop("high", 1.0))
    return search_active_set(Shares(weight, cost, budget, power, low, high), **more)


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
    args: dict[str, Any] = {"power": 2.0, "low": 0.05, "high": 1.0}
    result = allocate_by_active_set(WEIGHT, COST, budget, max_iterations=PLENTY, **args)
    assert result.converged
    assert result.iterations == passes
    assert_allclose(result.x, allocate(WEIGHT, COST, budget, **args).x, rtol=1e-15)


@pytest.mark.parametrize("budget", [1.0, 1.75, 35.0, 50.0])
def test_budgets_that_leave_no_choice(budget: float) -> None:
    """Infeasible, exactly feasible and full budgets give the bounds exactly."""
    result = allocate_by_active_set(
        WEIGHT, COST, budget, power=2.0, low=0.05, high=1.0, max_iterations=1
    )
    assert_array_equal(result.x, 1.0 if budget >= 35.0 else 0.05)
    assert result.feasible == (budget >= 1.75)
    assert result.converged


def test_a_multiplier_that_turns_negative_leaves_the_set() -> None:
    """Begun with the light object in full, which the optimum lets go of again."""
    weight, cost = np.array([1.0, 100.0, 100.0]), np.ones(3)
    args: dict[str, Any] = {"power": 2.0, "low": 0.01, "high": 1.0}
    start = np.array([1.0, 0.01, 0.01])
    result = allocate_by_active_set(weight, cost, 1.05, start=start, max_iterations=PLENTY, **args)
    assert_allclose(result.x, (0.05, 0.5, 0.5), rtol=1e-12)


@settings(deadline=None, max_examples=100)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(1, 60),
    begin=st.sampled_from(("low", "high", "random")),
    power=st.sampled_from((2.0, 3.0)),
)
def test_agrees_with_newton_from_anywhere(
    kkt_residual: Callable[..., float], seed: int, n: int, begin: str, power: float
) -> None:
    """The same optimum from the lowest, the highest and any other start."""
    weight, cost, low, budget = random_instance(seed, n)
    start = {
        "low": None,
        "high": np.ones(n),
        "random": np.random.default_rng(seed).uniform(0.0, 1.2, n),
    }[begin]
    args: dict[str, Any] = {"power": power, "low": low, "high": 1.0}
    found = allocate_by_active_set(weight, cost, budget, max_iterations=PLENTY, start=start, **args)
    assert found.converged
    assert kkt_residual(found, weight, cost, budget, **args) < 1e-9
    best = allocate(weight, cost, budget, **args)
    assert_allclose(found.x, best.x, rtol=1e-12)
    assert found.multiplier == pytest.approx(best.multiplier, rel=1e-11)


@pytest.mark.parametrize("start", [None, np.ones(200)], ids=["cold", "warm"])
def test_stops_anywhere_within_bounds_and_budget(start: FloatArray | None) -> None:
    """After any number of passes the point is feasible, and more passes bring it closer."""
    weight, cost, low, budget = random_instance(3, 200)
    degradation: list[float] = []
    converged, passes = False, 0
    while not converged:
        passes += 1
        result = allocate_by_active_set(
            weight, cost, budget, power=2.0, low=low, high=1.0, max_iterations=passes, start=start
        )
        converged = result.converged
        assert result.iterations == passes
        assert float(cost @ result.x) <= budget * (1.0 + 1e-12)
        assert (result.x >= low).all()
        assert (result.x <= 1.0).all()
        degradation.append(float((weight / result.x).sum()))
    best = float((weight / allocate(weight, cost, budget, power=2.0, low=low, high=1.0).x).sum())
    assert degradation[-1] == pytest.approx(best, rel=1e-12)
    assert (np.diff(degradation[2:]) <= 1e-9).all()


def test_a_warm_start_needs_fewer_passes() -> None:
    """From the optimum of a frame that differs little, a fraction of the cold start's passes."""
    weight, cost, low, budget = random_instance(4, 1000)
    args: dict[str, Any] = {"power": 2.0, "low": low, "high": 1.0, "max_iterations": PLENTY}
    before = allocate_by_active_set(weight, cost, budget, **args)
    moved = weight * np.exp(np.random.default_rng(5).normal(0.0, 0.002, 1000))
    cold = allocate_by_active_set(moved, cost, 0.999 * budget, **args)
    warm = allocate_by_active_set(moved, cost, 0.999 * budget, start=before.x, **args)
    assert_allclose(warm.x, cold.x, rtol=1e-12)
    assert warm.iterations < 0.3 * cold.iterations


def test_a_repeated_frame_takes_a_few_passes() -> None:
    """Begun at the optimum itself, the bounds that hold are found again at once."""
    weight, cost, low, budget = random_instance(6, 1000)
    args: dict[str, Any] = {"power": 3.0, "low": low, "high": 1.0, "max_iterations": PLENTY}
    before = allocate_by_active_set(weight, cost, budget, **args)
    again = allocate_by_active_set(weight, cost, budget, start=before.x, **args)
    assert again.iterations <= 8
    assert_allclose(again.x, before.x, rtol=1e-12)


def test_free_and_worthless_objects() -> None:
    """What costs nothing is full and what weighs nothing is lowest, as Newton has it."""
    weight, cost = np.array([1.0, 0.0, 4.0, 1.0]), np.array([0.0, 1.0, 1.0, 1.0])
    result = allocate_by_active_set(
        weight, cost, 0.85, power=2.0, low=0.1, high=1.0, max_iterations=PLENTY
    )
    assert_allclose(result.x, (1.0, 0.1, 0.5, 0.25), rtol=1e-14)
