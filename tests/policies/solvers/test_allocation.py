"""The allocation solver by hand: published oracles, the papers' closed forms, and edge cases."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.policies.solvers.allocation import allocate

WEIGHT = np.array([400.0, 100.0, 25.0])
COST = np.array([20.0, 10.0, 5.0])
Residual = Callable[..., float]


@pytest.mark.parametrize(
    ("budget", "x", "multiplier", "degradation"),
    [
        (5.0, (0.169084, 0.119561, 0.084542), 699.558441, 3497.792206),
        (20.0, (0.676337, 0.478242, 0.338168), 43.722403, 874.448052),
        (30.0, (1.0, 0.738796, 0.522408), 18.321068, 583.210678),
    ],
)
def test_gobbetti_bouvier_by_hand(
    budget: float, x: tuple[float, ...], multiplier: float, degradation: float
) -> None:
    """Three objects worked by hand; in the last case the first is at full resolution."""
    result = allocate(WEIGHT, COST, budget, power=2.0, low=0.05, high=1.0)
    assert_allclose(result.x, x, atol=5e-7)
    assert result.multiplier == pytest.approx(multiplier, abs=5e-7)
    assert float((WEIGHT / result.x).sum()) == pytest.approx(degradation, abs=5e-7)
    assert (result.x >= 1.0).tolist() == [budget == 30.0, False, False]
    assert (result.x > 0.05).all()


@pytest.mark.parametrize(
    ("alpha", "counts"),
    [
        (1.0, (7561.44, 1890.36, 472.59, 75.61)),
        (2.0, (5405.41, 2702.70, 1351.35, 540.54)),
        (3.0, (4459.80, 2809.50, 1769.87, 960.83)),
        (5.0, (3662.58, 2775.72, 2103.60, 1458.10)),
    ],
)
def test_peng_by_hand(alpha: float, counts: tuple[float, ...]) -> None:
    """Equation 1 of Peng et al. for 10,000 vertices over four areas."""
    area = np.array([10000.0, 2500.0, 625.0, 100.0])
    result = allocate(area, np.ones(4), 10000.0, power=alpha)
    assert_allclose(result.x, counts, atol=0.005)
    assert result.iterations == 1


def test_four_papers_are_one_allocation() -> None:
    """Gobbetti without bounds = Wimmer = Peng with alpha m + 1, each by its own printed formula."""
    rng = np.random.default_rng(1)
    area, full = rng.uniform(10.0, 1e4, 50), rng.uniform(100.0, 1e4, 50)
    per_triangle, budget = 5e-6, 0.4
    cost = per_triangle * full
    for m in (1, 2):
        degradation = area / full**m  # of 1 - accuracy, area · E / (r n)^m with E = 1
        unit = (degradation / cost) ** (1.0 / (m + 1))
        gobbetti = unit * budget / (cost @ unit)
        share = area ** (1.0 / (m + 1))
        peng = budget / per_triangle * share / share.sum() / full
        wide = allocate(m * degradation, cost, budget, power=m + 1.0, low=1e-9, high=1e9)
        wimmer = allocate(m * degradation, cost, budget, power=m + 1.0)
        for found in (wide.x, wimmer.x, peng):
            assert_allclose(found, gobbetti, rtol=1e-13)


def test_zach_smooth_half() -> None:
    """Σ c sqrt(x) over Σ x = X has x in proportion to c², which Algorithm 1's print omits."""
    c = np.array([1.0, 2.0, 5.0])
    result = allocate(c / 2.0, np.ones(3), 60.0, power=0.5)
    assert_allclose(result.x, (2.0, 8.0, 50.0), rtol=1e-14)
    size = np.array([3.0, 1.0, 2.0])
    split = allocate(size**2, np.ones(3), 98.0, power=0.5)
    assert_allclose(split.x, (81.0, 1.0, 16.0), rtol=1e-14)


def test_no_transfer_between_two_improves_the_optimum() -> None:
    """Moving any cost from one object to another lowers the sum of Funkhouser's accuracies."""
    rng = np.random.default_rng(2)
    area = rng.uniform(1.0, 1000.0, 30)
    best = allocate(2.0 * area, np.ones(30), 3000.0, power=3.0, low=5.0, high=200.0)
    error = float((area / best.x**2).sum())
    for _ in range(20_000):
        giver, taker = rng.choice(30, 2, replace=False)
        moved = min(best.x[giver] - 5.0, 200.0 - best.x[taker]) * rng.random()
        change = area[giver] / (best.x[giver] - moved) ** 2 - area[giver] / best.x[giver] ** 2
        change += area[taker] / (best.x[taker] + moved) ** 2 - area[taker] / best.x[taker] ** 2
        assert change >= -1e-12 * error


def test_infeasible_is_low_and_says_so() -> None:
    """A budget below the cost of all lower bounds gives exactly these, flagged."""
    result = allocate(WEIGHT, COST, 1.0, power=2.0, low=0.05, high=1.0)
    assert_array_equal(result.x, 0.05)
    assert not result.feasible
    assert result.converged
    assert result.multiplier == math.inf


def test_a_budget_of_exactly_the_lower_bounds(kkt_residual: Residual) -> None:
    """It is feasible, and the multiplier is the largest value per cost there."""
    low = np.array([0.25, 0.5, 0.5])
    result = allocate(WEIGHT, COST, 12.5, power=2.0, low=low, high=1.0)
    assert_array_equal(result.x, low)
    assert result.feasible
    assert result.multiplier == pytest.approx(400.0 / (20.0 * 0.25**2), rel=1e-15)
    assert kkt_residual(result, WEIGHT, COST, 12.5, power=2.0, low=low, high=1.0) < 1e-15


@pytest.mark.parametrize("budget", [35.0, 36.0, math.inf])
def test_everything_in_full(budget: float) -> None:
    """A budget of at least the full cost gives exactly the upper bounds and no price."""
    result = allocate(WEIGHT, COST, budget, power=2.0, low=0.05, high=1.0)
    assert_array_equal(result.x, 1.0)
    assert result.multiplier == 0.0


@pytest.mark.parametrize("power", [0.5, 2.0, 3.0, 4.5])
def test_a_single_object_takes_the_budget(power: float) -> None:
    """With one object x = budget / cost, whatever its weight."""
    result = allocate(np.array([7.0]), np.array([4.0]), 2.0, power=power, low=0.1, high=1.0)
    assert_allclose(result.x, 0.5, rtol=1e-15)
    assert result.multiplier == pytest.approx(7.0 / 4.0 * 0.5**-power, rel=1e-14)


def test_no_object() -> None:
    """Nothing to share is feasible while the budget is not overdrawn."""
    nothing = np.zeros(0)
    assert allocate(nothing, nothing, 1.0, power=2.0).feasible
    assert not allocate(nothing, nothing, -1.0, power=2.0).feasible


def test_what_costs_nothing_is_full_and_what_weighs_nothing_is_not() -> None:
    """Free detail is taken; detail without value is bought only when all else is bought."""
    weight, cost = np.array([1.0, 0.0, 4.0]), np.array([0.0, 1.0, 1.0])
    some = allocate(weight, cost, 0.8, power=2.0, low=0.1, high=1.0)
    assert_allclose(some.x, (1.0, 0.1, 0.7), rtol=1e-15)
    more = allocate(weight, cost, 1.5, power=2.0, low=0.1, high=1.0)
    assert_allclose(more.x, (1.0, 0.1, 1.0), rtol=1e-15)
    assert_array_equal(allocate(weight, cost, 2.0, power=2.0, low=0.1, high=1.0).x, 1.0)


def test_equal_bounds_are_kept() -> None:
    """An object without a choice keeps its x, and the others share what is left."""
    low = np.array([0.05, 1.0, 0.05])
    result = allocate(WEIGHT, COST, 20.0, power=2.0, low=low, high=1.0)
    assert result.x[1] == 1.0
    assert_allclose(COST @ result.x, 20.0, rtol=1e-15)
    assert_allclose(WEIGHT[0] / result.x[0] ** 2 / 20.0, WEIGHT[2] / result.x[2] ** 2 / 5.0)


def test_a_residual_sees_what_is_not_optimal(kkt_residual: Residual) -> None:
    """The residual of another feasible point is not small, so a small one means something."""
    best = allocate(WEIGHT, COST, 20.0, power=2.0, low=0.05, high=1.0)
    skewed = allocate(WEIGHT * [1.0, 1.01, 1.0], COST, 20.0, power=2.0, low=0.05, high=1.0)
    args: dict[str, Any] = {"power": 2.0, "low": 0.05, "high": 1.0}
    assert kkt_residual(best, WEIGHT, COST, 20.0, **args) < 1e-14
    assert kkt_residual(skewed, WEIGHT, COST, 20.0, **args) > 1e-3
    assert kkt_residual(best, WEIGHT, COST, 20.5, **args) > 1e-2


wide = st.floats(1e-6, 1e6)


@settings(deadline=None, max_examples=300)
@given(
    objects=st.lists(st.tuples(wide, wide, st.floats(1e-6, 1.0)), min_size=1, max_size=40),
    part=st.floats(0.001, 0.999),
    power=st.sampled_from((0.5, 2.0, 3.0, 5.0)),
)
def test_any_instance_is_solved(
    kkt_residual: Residual, objects: list[tuple[float, float, float]], part: float, power: float
) -> None:
    """Weights and costs over twelve decades are solved to a residual of 1e-9 in few passes."""
    weight, cost, low = (np.array(column) for column in zip(*objects, strict=True))
    floor, full = float(cost @ low), float(cost.sum())
    budget = floor + part * (full - floor)
    result = allocate(weight, cost, budget, power=power, low=low, high=1.0)
    if floor < budget < full:
        assert kkt_residual(result, weight, cost, budget, power=power, low=low, high=1.0) < 1e-9
    # At worst every second pass halves a range of twelve decades down to a number's 53 bits.
    assert result.iterations <= 2 * (53 + 40)


@settings(deadline=None, max_examples=100)
@given(seed=st.integers(0, 10_000), part=st.floats(0.0, 0.9), more=st.floats(0.0, 1.0))
@example(seed=540, part=0.0, more=1.0)  # the sum of all costs, short by a rounding
def test_more_budget_takes_from_nobody(seed: int, part: float, more: float) -> None:
    """Every x grows, or stays, when the budget grows."""
    rng = np.random.default_rng(seed)
    weight, cost = np.exp(rng.normal(0.0, 2.0, (2, 20)))
    low = rng.uniform(0.01, 0.5, 20)
    floor = float(cost @ low)
    room = float(cost.sum()) - floor
    little, much = (
        allocate(weight, cost, floor + share * room, power=2.0, low=low, high=1.0).x
        for share in (part, part + (1.0 - part) * more)
    )
    assert (much >= little * (1.0 - 1e-12)).all()


@settings(deadline=None, max_examples=50)
@given(seed=st.integers(0, 10_000))
def test_order_does_not_matter(seed: int) -> None:
    """Renumbering objects renumbers the shares."""
    rng = np.random.default_rng(seed)
    weight, cost = np.exp(rng.normal(0.0, 2.0, (2, 25)))
    order = rng.permutation(25)
    args: dict[str, Any] = {"power": 2.0, "low": 0.1, "high": 1.0}
    budget = 0.4 * float(cost.sum())
    plain = allocate(weight, cost, budget, **args).x
    mixed = allocate(weight[order], cost[order], budget, **args).x
    assert_allclose(mixed, plain[order], rtol=1e-12)
