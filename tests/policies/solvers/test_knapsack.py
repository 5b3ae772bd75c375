"""The multiple-choice knapsack, compared with brute force and HiGHS."""

import itertools

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from lodbench.policies.solvers.knapsack import (
    Choice,
    affordable,
    best_single,
    hull_increments,
    relaxed_bound,
    take_increments,
)

Table = NDArray[np.float64]


def gouraud(area: float, samples: list[float], exponent: int) -> list[float]:
    """Benefits of levels with these samples: area times accuracy."""
    return [area * (1.0 - 0.5 / n**exponent) for n in samples]


def brute_force(cost: Table, benefit: Table, budget: float) -> float:
    """Return the most benefit of any affordable combination; minus infinity if there is none."""
    rows = np.arange(len(cost))
    best = -np.inf
    for columns in itertools.product(range(cost.shape[1]), repeat=len(cost)):
        if cost[rows, columns].sum() <= budget:
            best = max(best, float(benefit[rows, columns].sum()))
    return best


def highs(cost: Table, benefit: Table, budget: float) -> float:
    """Return the exact optimum by scipy's HiGHS."""
    n, width = cost.shape
    one_each = sp.kron(sp.eye(n), np.ones((1, width)), format="csr")
    solution = milp(
        -benefit.ravel(),
        constraints=[
            LinearConstraint(one_each, 1, 1),
            LinearConstraint(cost.reshape(1, -1), -np.inf, budget),
        ],
        integrality=[1] * (n * width),
        bounds=Bounds(0, 1),
        options={"mip_rel_gap": 1e-9},
    )
    assert solution.fun is not None, solution.message
    return -float(solution.fun)


@st.composite
def instances(draw: st.DrawFn) -> tuple[Table, Table, float]:
    """Draw up to five objects of up to four choices, and a budget that the base meets."""
    n, width = draw(st.integers(1, 5)), draw(st.integers(1, 4))
    values = st.floats(0.001, 100.0)
    cost = np.array(draw(st.lists(values, min_size=n * width, max_size=n * width)))
    benefit = np.array(draw(st.lists(values, min_size=n * width, max_size=n * width)))
    cost = cost.reshape(n, width)
    low, high = cost.min(axis=1).sum(), cost.max(axis=1).sum()
    share = draw(st.floats(0.0, 1.1))
    return cost, benefit.reshape(n, width), float(low + share * (high - low))


@pytest.mark.parametrize(
    ("budget", "levels", "benefit"),
    [
        (400, (1, 1, 1), 521.71875),
        (1000, (2, 2, 2), 524.179688),
        (1700, (2, 2, 2), 524.179688),
        (3000, (3, 3, 2), 524.765625),
    ],
)
def test_three_objects_by_hand(budget: int, levels: tuple[int, ...], benefit: float) -> None:
    """The hull greedy finds the levels that enumeration by hand gives for three objects."""
    samples = [20.0, 80.0, 320.0, 1280.0]
    cost = np.tile(samples, (3, 1))
    table = np.array([gouraud(area, samples, 1) for area in (400.0, 100.0, 25.0)])
    increments = hull_increments(cost, table)
    for skip in (False, True):
        choice = take_increments(increments, budget, skip_misfits=skip)
        assert tuple(choice.column) == levels
        assert choice.benefit == pytest.approx(benefit, abs=1e-6)


def test_optimum_that_the_hull_greedy_misses() -> None:
    """At a budget of 1700 the optimum is (3, 2, 1), which only enumeration finds."""
    samples = [20.0, 80.0, 320.0, 1280.0]
    cost = np.tile(samples, (3, 1))
    table = np.array([gouraud(area, samples, 1) for area in (400.0, 100.0, 25.0)])
    assert brute_force(cost, table, 1700) == pytest.approx(524.53125)
    assert relaxed_bound(hull_increments(cost, table), 1700) >= 524.53125


def test_ratio_order_has_no_bound_but_the_single_increment_mends_it() -> None:
    """Of (0.02, cost 1) and (1, cost 100) within 100 the pass takes 0.02, the optimum is 1."""
    cost = np.array([[1.0, 0.0], [100.0, 0.0]])
    benefit = np.array([[0.02, 0.0], [1.0, 0.0]])
    increments = hull_increments(cost, benefit)
    assert take_increments(increments, 100.0, skip_misfits=True).benefit == pytest.approx(0.02)
    assert best_single(cost, benefit, increments, 100.0)[1] == pytest.approx(1.0)
    assert brute_force(cost, benefit, 100.0) == 1.0


def test_what_just_fits_is_affordable() -> None:
    """At 1 and 0 with 3 to spend, either object may take its dear choice: 2 more is what is left.

    With 2.9 neither may.
    """
    cost = np.array([[3.0, 1.0], [2.0, 0.0]])
    assert affordable(cost, 3.0).tolist() == cost.tolist()
    assert affordable(cost, 2.9).tolist() == [[np.inf, 1.0], [np.inf, 0.0]]


def test_what_just_fits_after_a_misfit_is_taken() -> None:
    """Of increments (2, 8), (4, 12) and (1, 1) within 3, the first and the last fill it."""
    cost = np.array([[2.0, 0.0], [4.0, 0.0], [1.0, 0.0]])
    benefit = np.array([[8.0, 0.0], [12.0, 0.0], [1.0, 0.0]])
    choice = take_increments(hull_increments(cost, benefit), 3.0, skip_misfits=True)
    assert choice.column.tolist() == [0, 1, 0]
    assert (choice.cost, choice.benefit) == (3.0, 9.0)


@given(instances())
def test_choices_are_what_they_say_and_at_least_half_optimal(
    instance: tuple[Table, Table, float],
) -> None:
    """Sums agree with columns, the budget holds, half the optimal gain is reached, bound holds."""
    cost, benefit, budget = instance
    rows = np.arange(len(cost))
    cost = affordable(cost, budget)
    increments = hull_increments(cost, benefit)
    single, single_benefit = best_single(cost, benefit, increments, budget)
    assert single_benefit == pytest.approx(benefit[rows, single].sum())
    assert cost[rows, single].sum() <= budget + 1e-9
    optimum = brute_force(cost, benefit, budget)
    for skip in (False, True):
        choice = take_increments(increments, budget, skip_misfits=skip)
        assert choice.cost == pytest.approx(cost[rows, choice.column].sum())
        assert choice.benefit == pytest.approx(benefit[rows, choice.column].sum())
        assert choice.cost <= budget + 1e-9
        best = max(choice.benefit, single_benefit)
        base = increments.base_benefit
        assert 2.0 * (best - base) >= optimum - base - 1e-9
    assert relaxed_bound(increments, budget) >= optimum - 1e-9


def test_a_vertex_that_can_never_be_taken_must_not_hide_those_below_it() -> None:
    """Three objects at (33, 25) are optimal within 99.9, but lie below the edge to (100, 99)."""
    cost = np.tile([100.0, 33.0, 1.0, 0.0], (3, 1))
    benefit = np.tile([99.0, 25.0, 1.0, 0.0], (3, 1))
    hidden = hull_increments(cost, benefit)
    assert take_increments(hidden, 99.9, skip_misfits=True).benefit == 3.0
    assert best_single(cost, benefit, hidden, 99.9)[1] == 25.0
    seen = hull_increments(affordable(cost, 99.9), benefit)
    assert take_increments(seen, 99.9, skip_misfits=True).benefit == 75.0


@given(instances())
def test_skipping_misfits_never_loses(instance: tuple[Table, Table, float]) -> None:
    """Going on behind a misfit only adds benefit to the selection that stops there."""
    cost, benefit, budget = instance
    increments = hull_increments(cost, benefit)
    stop = take_increments(increments, budget, skip_misfits=False)
    skip = take_increments(increments, budget, skip_misfits=True)
    assert skip.benefit >= stop.benefit - 1e-9


@given(instances(), st.floats(1.0, 2.0))
def test_more_budget_never_lowers_the_bound_or_the_stopping_pass(
    instance: tuple[Table, Table, float], factor: float
) -> None:
    """Both the relaxation and the prefix of increments grow with the budget."""
    cost, benefit, budget = instance
    increments = hull_increments(cost, benefit)
    assert relaxed_bound(increments, budget * factor) >= relaxed_bound(increments, budget) - 1e-9
    more = take_increments(increments, budget * factor, skip_misfits=False)
    less = take_increments(increments, budget, skip_misfits=False)
    assert more.benefit >= less.benefit - 1e-9


def test_base_that_does_not_fit_is_returned_and_unbounded_below() -> None:
    """With less budget than the cheapest choices the base is drawn and no bound exists."""
    cost, benefit = np.array([[2.0, 3.0]]), np.array([[1.0, 2.0]])
    increments = hull_increments(cost, benefit)
    assert take_increments(increments, 1.0, skip_misfits=True).column.tolist() == [0]
    assert relaxed_bound(increments, 1.0) == -np.inf


def test_choices_below_the_hull_are_never_taken() -> None:
    """A level that costs more than its share of benefit on the way to a finer one is jumped."""
    cost = np.array([[1.0, 2.0, 3.0]])
    benefit = np.array([[0.0, 0.1, 2.0]])
    assert hull_increments(cost, benefit).column.tolist() == [2]


def large(rng: np.random.Generator) -> tuple[Table, Table, float]:
    """3,000 objects of five levels with concave benefit, and a budget for the middle level."""
    area = rng.pareto(1.0, 3000) * 100.0
    cost = np.tile([20.0, 80.0, 320.0, 1280.0, 5000.0], (3000, 1))
    cost *= rng.uniform(0.5, 2.0, (3000, 1))
    benefit = area[:, None] * (1.0 - 0.5 / cost)
    return cost, benefit, float(cost[:, 2].sum())


def hull_choice(cost: Table, benefit: Table, budget: float) -> Choice:
    """Return the selection of the hull pass that stops."""
    return take_increments(hull_increments(cost, benefit), budget, skip_misfits=False)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_hull_pass_is_within_a_ten_thousandth_of_highs(seed: int) -> None:
    """At 3,000 objects of five levels the pass reaches 0.9999 of HiGHS's exact optimum."""
    cost, benefit, budget = large(np.random.default_rng(seed))
    optimum = highs(cost, benefit, budget)
    assert hull_choice(cost, benefit, budget).benefit >= 0.9999 * optimum
    assert relaxed_bound(hull_increments(cost, benefit), budget) >= optimum * (1.0 - 1e-9)
