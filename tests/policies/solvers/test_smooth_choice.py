"""The convex optimum with continuous objects, compared with casadi's ipopt and closed forms."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.knapsack import hull_increments, relaxed_bound
from lodbench.policies.solvers.smooth_choice import SmoothChoice


def problem(weight: list[float], samples: list[list[float]], soft: list[bool]) -> SmoothChoice:
    """Build objects that cost one unit a sample."""
    table, w = np.array(samples), np.array(weight)
    benefit = w[:, None] * (1.0 - 0.5 / table)
    return SmoothChoice(table, benefit, table, w, np.array(soft))


def samples_of(choice: SmoothChoice, budget: float) -> np.ndarray:
    """Return the samples of each object in the best selection within a budget."""
    best, _ = choice.within(budget)
    rows = np.arange(len(best.column))
    low = choice.samples[rows, best.column]
    high = choice.samples[rows, np.maximum(best.column - 1, 0)]
    return low + best.share * (high - low)


def test_square_root_shares_by_hand() -> None:
    """Without active bounds samples go with the square root of the weight."""
    choice = problem([400.0, 100.0, 25.0], [[1e4, 1.0]] * 3, [True] * 3)
    found = samples_of(choice, 350.0)
    assert found == pytest.approx([200.0, 100.0, 50.0], rel=1e-9)


def test_bounds_hold_and_the_rest_is_shared() -> None:
    """An object at its finest frees budget, which the others share."""
    choice = problem([400.0, 100.0, 25.0], [[120.0, 1.0], [1e4, 1.0], [1e4, 1.0]], [True] * 3)
    assert samples_of(choice, 420.0) == pytest.approx([120.0, 200.0, 100.0], rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_ipopt(seed: int) -> None:
    """On random continuous objects the benefit is that of casadi's interior point solver."""
    rng = np.random.default_rng(seed)
    n = 12
    weight = rng.uniform(1.0, 100.0, size=(n,))
    high = rng.uniform(50.0, 500.0, size=(n,))
    low = high * 0.1
    budget = float(np.sum(low + rng.random() * (high - low)))
    choice = problem(weight.tolist(), np.stack((high, low), axis=1).tolist(), [True] * n)
    best, bound = choice.within(budget)
    x = ca.SX.sym("x", n)
    solver = ca.nlpsol(
        "s",
        "ipopt",
        {"x": x, "f": ca.sum1(ca.DM(weight) * 0.5 / x), "g": ca.sum1(x)},
        {"ipopt.print_level": 0, "print_time": False, "ipopt.tol": 1e-12},
    )
    solution = solver(x0=low, lbx=low, ubx=high, ubg=budget, lbg=-np.inf)
    loss = np.asarray(solution["f"], dtype=np.float64)
    optimum = float(weight.sum() - loss.sum())
    assert best.cost <= budget
    assert best.benefit == pytest.approx(optimum, rel=1e-7)
    assert bound == pytest.approx(best.benefit, rel=1e-9)


@given(st.integers(0, 2**31), st.integers(1, 8), st.floats(0.0, 1.2))
def test_mixed_selections_fit_and_never_exceed_the_bound(seed: int, n: int, part: float) -> None:
    """Discrete and continuous objects together keep the budget, and the dual bounds them."""
    rng = np.random.default_rng(seed)
    table = np.sort(rng.uniform(1.0, 500.0, (n, 3)), axis=1)[:, ::-1]
    soft = rng.random(n) < 0.5
    choice = problem(rng.uniform(0.1, 9.0, n).tolist(), table.tolist(), soft.tolist())
    low, high = table[:, -1].sum(), table[:, 0].sum()
    budget = float(low + part * (high - low))
    best, bound = choice.within(budget)
    assert best.cost <= budget * (1.0 + 1e-12)
    assert best.benefit <= bound * (1.0 + 1e-12)
    if not soft.any():
        hull = relaxed_bound(hull_increments(choice.cost, choice.benefit), budget)
        assert bound == pytest.approx(hull, rel=1e-9)


def test_budget_below_the_coarsest_has_no_bound() -> None:
    """The coarsest selection is returned, over the budget, and nothing bounds it."""
    best, bound = problem([1.0], [[9.0, 3.0]], [True]).within(1.0)
    assert best.cost == 3.0
    assert bound == -np.inf
