"""Raising smooth variables: by hand, against ipopt and the allocation, and where it stops."""

from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.allocation import allocate
from lodbench.policies.solvers.smooth_ascent import Ascent, GradientAscent, NewtonAscent

ENGINES = ("bent", "gradient", "newton")


def make(engine: str, weight: Any, low: Any, high: Any, barrier: float = 0.0) -> Ascent:
    """Return variables raised by an engine; single bounds stand for all."""
    weight = np.asarray(weight, dtype=np.float64)
    low, high = (np.broadcast_to(np.asarray(b, dtype=float), weight.shape) for b in (low, high))
    if engine == "newton":
        return NewtonAscent(weight, low, high)
    return GradientAscent(weight, low, high, barrier=barrier, bent=engine == "bent")


def climb(ascent: Ascent, spend: float) -> int:
    """Raise until nothing is left to spend or to raise; return the number of steps."""
    for step in range(10_000):
        if spend <= 1e-11 or ascent.slope() <= 0.0:
            return step
        spend -= ascent.raise_to(0.0, spend)
    raise AssertionError("does not end")


def instance(seed: int, n: int) -> tuple[Any, Any, Any, float]:
    """Return weights, bounds and a budget that leaves variables at both bounds and between."""
    rng = np.random.default_rng(seed)
    weight = np.exp(rng.normal(0.0, 1.5, n))
    high = rng.uniform(0.5, 4.0, n)
    low = high * rng.uniform(0.01, 0.3, n)
    return weight, low, high, 0.4 * float((high - low).sum())


@pytest.mark.parametrize("engine", ENGINES)
def test_shares_without_bounds_go_by_the_square_of_the_weight(engine: str) -> None:
    """Weights 3 and 4 share 25 as 9 and 16, the solution by Lagrange multipliers."""
    ascent = make(engine, [3.0, 4.0], 0.0, 100.0)
    climb(ascent, 25.0)
    assert ascent.x == pytest.approx([9.0, 16.0], rel=1e-9)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_line_search_stops_where_benefit_per_cost_falls_to_the_slope(engine: str) -> None:
    """Then 3 / (2 sqrt(x)) and 4 / (2 sqrt(x)) are 0.5, with x = 9 and 16, and slope says so."""
    ascent = make(engine, [3.0, 4.0], 0.25, 100.0)
    before = ascent.x.sum()
    spent = 0.0
    while ascent.slope() > 0.5 * (1.0 + 1e-9):
        spent += ascent.raise_to(0.5, 1000.0)
    assert ascent.x == pytest.approx([9.0, 16.0], rel=1e-9)
    assert spent == pytest.approx(25.0 - before)
    assert ascent.slope() == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(20))
def test_a_slope_divides_what_is_raised_from_what_is_not(engine: str, seed: int) -> None:
    """With bounds, a variable is at its lowest, at its highest, or has just that slope."""
    weight, low, high, _ = instance(seed, 30)
    slope = float(np.median(weight / (2.0 * np.sqrt(low + 0.3 * (high - low)))))
    ascent = make(engine, weight, low, high)
    for _ in range(200):
        if ascent.slope() <= slope * (1.0 + 1e-9):
            break
        ascent.raise_to(slope, 1e9)
    right = np.clip((weight / (2.0 * slope)) ** 2, low, high)
    assert ascent.x == pytest.approx(right, rel=1e-8)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(10))
def test_the_optimum_is_that_of_ipopt_and_of_the_allocation(engine: str, seed: int) -> None:
    """With bounds active on both sides; the barrier costs less than a thousandth."""
    weight, low, high, spend = instance(seed, 12)
    library: Any = casadi
    x = library.SX.sym("x", 12)
    problem = {"x": x, "f": -library.dot(weight, library.sqrt(x)), "g": library.sum1(x)}
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10}
    solver: Any = library.nlpsol("solver", "ipopt", problem, quiet)
    budget = float(low.sum()) + spend
    found = solver(x0=0.5 * (low + high), lbx=low, ubx=high, ubg=budget)
    best = -float(found["f"])
    exact = allocate(0.5 * weight, np.ones(12), budget, power=0.5, low=low, high=high).x
    assert exact.min() < high.max()
    for barrier, tolerance in ((0.0, 1e-7), (1e-3, 1e-3)):
        ascent = make(engine, weight, low, high, barrier)
        climb(ascent, spend)
        assert float(ascent.x.sum()) <= budget * (1.0 + 1e-12)
        reached = float(weight @ np.sqrt(ascent.x))
        assert reached >= best * (1.0 - tolerance)
        assert reached <= best * (1.0 + 1e-7)
        if barrier == 0.0:
            assert ascent.x == pytest.approx(exact, rel=1e-6)


def test_a_printed_ray_ends_at_the_first_bound() -> None:
    """Of weights 3 and 4 below 4 and 1, the second is full where the first is at 9 / 16."""
    ascent = make("gradient", [3.0, 4.0], 0.0, [4.0, 1.0])
    assert ascent.slope() == np.inf
    ascent.raise_to(0.0, 100.0)
    assert ascent.x == pytest.approx([9.0 / 16.0, 1.0])
    bent = make("bent", [3.0, 4.0], 0.0, [4.0, 1.0])
    bent.slope()
    assert bent.raise_to(0.0, 100.0) == pytest.approx(5.0)


def test_the_barrier_slows_what_nears_its_bound() -> None:
    """At half its highest root a weight of 2 has 2 (1 - 0.25 / 0.5) = 1, the gradient of a 1."""
    ascent = make("bent", [2.0, 1.0], [0.25, 0.0], [1.0, 1.0], barrier=0.25)
    ascent.slope()
    ascent.raise_to(0.0, 0.0625)  # the second alone, to its root of a quarter
    ascent.slope()
    assert ascent.x == pytest.approx([0.25, 0.0625])
    before = np.sqrt(ascent.x)
    ascent.raise_to(0.0, 0.05)
    rise = np.sqrt(ascent.x) - before
    assert rise[0] == pytest.approx(rise[1] * 1.0 / (1.0 - 0.25 / 0.75))


def test_the_barrier_spares_steps() -> None:
    """With 200 variables that fill up one after another, a barrier of 0.05 halves the steps."""
    rng = np.random.default_rng(3)
    weight, high = rng.uniform(1.0, 3.0, 200), rng.uniform(0.5, 1.0, 200)
    spend = 0.95 * float(high.sum())
    steps = [
        climb(make("gradient", weight, 1e-4, high, barrier), spend - 0.02)
        for barrier in (0.0, 0.05)
    ]
    assert steps[1] < 0.5 * steps[0]


@pytest.mark.parametrize("engine", ENGINES)
def test_with_plenty_to_spend_everything_is_full(engine: str) -> None:
    """The barrier keeps nothing from its highest value when nothing else is left to raise."""
    weight, low, high, _ = instance(7, 20)
    ascent = make(engine, weight, low, high, barrier=1e-2)
    climb(ascent, 1e9)
    assert ascent.x == pytest.approx(high, rel=1e-12)
    assert ascent.slope() == 0.0


@pytest.mark.parametrize("engine", ENGINES)
def test_nothing_and_what_cannot_move(engine: str) -> None:
    """No variables, equal bounds and weightless variables end the climb at once."""
    for weight, low, high in (([], 0.0, 1.0), ([1.0, 2.0], 0.5, 0.5), ([0.0], 0.1, 1.0)):
        ascent = make(engine, weight, low, high)
        assert climb(ascent, 10.0) <= 1


@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 20),
    share=st.floats(0.0, 1.2),
    barrier=st.sampled_from([0.0, 1e-3, 0.1, 2.0]),
    engine=st.sampled_from(ENGINES),
)
def test_never_spends_more_than_it_may_and_never_lowers(
    seed: int, n: int, share: float, barrier: float, engine: str
) -> None:
    """What a step returns is what it spent, at most what it was given, and no variable falls."""
    weight, low, high, _ = instance(seed, n)
    ascent = make(engine, weight, low, high, barrier)
    spend = share * float((high - low).sum())
    for _ in range(8):
        slope, before = ascent.slope(), ascent.x
        if slope <= 0.0:
            break
        spent = ascent.raise_to(0.7 * slope if np.isfinite(slope) else 1.0, spend)
        after = ascent.x
        assert (after >= before * (1.0 - 1e-12)).all()
        assert (after <= high * (1.0 + 1e-12)).all()
        assert spent == pytest.approx(float((after - before).sum()), abs=1e-9)
        assert spent <= spend * (1.0 + 1e-12) + 1e-12 * float(after.sum())
        spend = max(spend - spent, 0.0)
