"""What is worth its setup: by hand, and against all subsets with their best shares."""

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.admission import admit
from lodbench.policies.solvers.allocation import allocate


def share(weight: Any, low: Any, high: Any, budget: float) -> Any:
    """Return the best shares of a budget."""
    return allocate(0.5 * weight, np.ones(len(weight)), budget, power=0.5, low=low, high=high).x


def test_things_are_drawn_by_the_scale_at_which_they_are_worth_their_setup() -> None:
    """Weights 2 and 1, setups 1: the first is worth it from scale 1/4 on, the second from 1 on.

    At scale 1 they cost 1 + 4 and 1 + 1, so that both are drawn from a budget of 7 on.
    """
    setup, weight = np.ones(2), np.array([2.0, 1.0])
    low, high = np.zeros(2), np.full(2, 100.0)
    for budget, drawn in ((1.99, []), (2.01, [0]), (6.99, [0]), (7.01, [0, 1])):
        found = admit(setup, low, high, weight, np.ones(2, dtype=bool), budget)
        assert found is not None
        assert found.drawn.tolist() == drawn


def test_what_is_not_optional_comes_first() -> None:
    """The second must be drawn though it is worth less; None where the budget is below 1 + 0.5."""
    setup, weight, low = np.ones(2), np.array([2.0, 0.1]), np.full(2, 0.5)
    optional = np.array([True, False])
    high = np.full(2, 100.0)
    assert admit(setup, low, high, weight, optional, 1.4) is None
    found = admit(setup, low, high, weight, optional, 1.6)
    assert found is not None
    assert found.drawn.tolist() == [1]
    found = admit(setup, low, high, weight, optional, 3.6)
    assert found is not None
    assert found.drawn.tolist() == [0, 1]


def test_nothing_to_draw() -> None:
    """No things need no budget, but not less than none."""
    none, no = np.zeros(0), np.zeros(0, dtype=bool)
    found = admit(none, none, none, none, no, 0.0)
    assert found is not None
    assert len(found.drawn) == 0
    assert admit(none, none, none, none, no, -1.0) is None


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 6), part=st.floats(0.01, 1.2))
def test_only_the_next_thing_parts_it_from_the_best_subset(seed: int, n: int, part: float) -> None:
    """Tangents make it a knapsack of falling slopes, whose relaxed optimum has one thing more."""
    rng = np.random.default_rng(seed)
    setup, weight = rng.uniform(0.1, 1.0, n), np.exp(rng.normal(0.0, 1.0, n))
    low, high = 0.1 * setup, setup * rng.uniform(1.0, 20.0, n)
    budget = part * float((setup + high).sum())
    found = admit(setup, low, high, weight, np.ones(n, dtype=bool), budget)
    assert found is not None

    def value(chosen: Any) -> float:
        left = budget - float(setup[chosen].sum())
        if left < float(low[chosen].sum()):
            return -np.inf
        return float(
            weight[chosen] @ np.sqrt(share(weight[chosen], low[chosen], high[chosen], left))
        )

    every = itertools.product([False, True], repeat=n)
    best = max(value(np.flatnonzero(np.array(chosen))) for chosen in every)
    reached = value(found.drawn)
    rest = np.setdiff1d(np.arange(n), found.drawn)
    entry = float((weight * np.sqrt(setup))[rest].max(initial=0.0))
    assert best * (1.0 + 1e-9) >= reached >= best - entry - 1e-9


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 30), part=st.floats(0.01, 1.2))
def test_the_scale_is_no_less_than_in_the_best_use_and_not_by_far(
    seed: int, n: int, part: float
) -> None:
    """Each of the best shares is at most ``scale · weight²``, and some more than half of it."""
    rng = np.random.default_rng(seed)
    optional = rng.random(n) < 0.7
    setup, weight = rng.choice([0.0, 0.5, 1.0], n), np.exp(rng.normal(0.0, 1.0, n))
    high = rng.uniform(0.5, 20.0, n)
    low = high * rng.choice([0.0, 0.1], n)
    budget = part * float((setup + high).sum())
    found = admit(setup, low, high, weight, optional, budget)
    if found is None:
        assert budget < float((setup + low)[~optional].sum())
        return
    at = found.drawn
    assert set(np.flatnonzero(~optional)) <= set(at.tolist())
    left = budget - float(setup[at].sum())
    assert left >= float(low[at].sum()) - 1e-9
    x = share(weight[at], low[at], high[at], left)
    bound = np.clip(found.scale * weight[at] ** 2, low[at], high[at])
    assert (x <= bound * (1.0 + 1e-9)).all()
    between = (x > low[at] * (1.0 + 1e-9)) & (x < high[at] * (1.0 - 1e-9))
    assert (x[between] >= 0.49 * found.scale * weight[at][between] ** 2).all()


def test_the_scale_of_everything_in_full_fills_everything() -> None:
    """With more than enough to spend the bound is each thing's greatest x."""
    weight, high = np.array([3.0, 0.01]), np.array([1.0, 50.0])
    found = admit(np.zeros(2), np.zeros(2), high, weight, np.ones(2, dtype=bool), 1e9)
    assert found is not None
    assert np.clip(found.scale * weight**2, 0.0, high) == pytest.approx(high)
