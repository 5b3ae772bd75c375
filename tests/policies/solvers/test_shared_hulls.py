"""Hulls that objects share, compared with a hull an object."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import linprog

from lodbench.policies.solvers.knapsack import (
    affordable,
    best_single,
    hull_increments,
    relaxed_bound,
    take_increments,
)
from lodbench.policies.solvers.shared_hulls import SharedHulls


@given(
    seed=st.integers(0, 10_000),
    n=st.integers(1, 40),
    skip=st.booleans(),
    single=st.booleans(),
)
def test_the_selection_is_that_of_a_hull_an_object(
    seed: int, n: int, skip: bool, single: bool
) -> None:
    """Classes of up to five levels, some lacking; budgets from too little to plenty, in turn."""
    rng = np.random.default_rng(seed)
    classes, width = int(rng.integers(1, 5)), int(rng.integers(1, 6))
    cost = np.sort(rng.uniform(0.1, 9.0, (classes, width)), axis=1)[:, ::-1].copy()
    value = np.sort(rng.uniform(0.0, 1.0, (classes, width)), axis=1)[:, ::-1].copy()
    count = rng.integers(1, width + 1, classes)
    cost[np.arange(width) >= count[:, None]] = np.inf
    kind, size = rng.integers(0, classes, n), np.exp(2.0 * rng.normal(size=n))
    size[rng.random(n) < 0.1] = 0.0
    hulls = SharedHulls(cost, value)
    each, benefit = cost[kind], size[:, None] * value[kind]
    cheapest, finest = float(each.min(axis=1).sum()), float(cost[kind, 0].sum())
    for share in (0.5, 0.52, 0.05, -0.1, 0.3, 1.1, 0.9):
        budget = cheapest + share * (finest - cheapest) + 1e-9
        fits = affordable(each, budget)
        increments = hull_increments(fits, benefit)
        choice = take_increments(increments, budget, skip_misfits=skip)
        column = choice.column
        if single:
            other, other_benefit = best_single(fits, benefit, increments, budget)
            column = other if other_benefit > choice.benefit + 1e-12 else column
        got = hulls.choose(kind, size, budget, skip_misfits=skip, or_single=single)
        assert got.column.tolist() == column.tolist()
        assert_allclose(got.cost, each[np.arange(n), column].sum(), rtol=1e-12)


def test_no_objects_cost_nothing() -> None:
    """An empty frame has an empty selection."""
    hulls = SharedHulls(np.array([[2.0, 1.0]]), np.array([[1.0, 0.5]]))
    nobody = np.zeros(0, dtype=np.intp)
    got = hulls.choose(nobody, np.zeros(0), 1.0, skip_misfits=True, or_single=True)
    assert (len(got.column), got.cost) == (0, 0.0)


@given(seed=st.integers(0, 10_000), n=st.integers(1, 40))
def test_the_bound_is_that_of_a_hull_an_object(seed: int, n: int) -> None:
    """Some levels lacking, some dominated, some sizes 0; budgets from too little to plenty."""
    rng = np.random.default_rng(seed)
    classes, width = int(rng.integers(1, 5)), int(rng.integers(1, 6))
    cost, value = rng.uniform(0.1, 9.0, (classes, width)), rng.uniform(0.0, 1.0, (classes, width))
    cost[np.arange(width) >= rng.integers(1, width + 1, classes)[:, None]] = np.inf
    kind, size = rng.integers(0, classes, n), np.exp(2.0 * rng.normal(size=n))
    size[rng.random(n) < 0.1] = 0.0
    hulls = SharedHulls(cost, value)
    increments = hull_increments(cost[kind], size[:, None] * value[kind])
    whole = float(increments.cost.sum())
    for share in (0.5, 0.52, 0.05, -0.1, 0.3, 1.1, 0.9):
        budget = increments.base_cost + share * whole + 1e-9
        got = hulls.bound(kind, size, budget)
        assert_allclose(got, relaxed_bound(increments, budget), rtol=1e-12)


def test_the_bound_is_the_optimum_of_the_linear_relaxation() -> None:
    """As HiGHS finds it, which knows of no hull; one level lies below its class's hull."""
    cost = np.array([[9.0, 5.0, 4.0, 1.0], [6.0, 3.0, 2.0, np.inf]])
    value = np.array([[1.0, 0.8, 0.3, 0.1], [0.9, 0.7, 0.2, 0.0]])
    kind, size = np.array([0, 1, 0, 1, 1]), np.array([3.0, 1.0, 0.5, 4.0, 2.0])
    real = np.isfinite(cost[kind])
    owner = np.nonzero(real)[0]
    each = (owner == np.arange(5)[:, None]).astype(np.float64)
    for budget in (8.5, 12.0, 20.0, 30.0, 40.0):
        solution: Any = linprog(
            -(size[:, None] * value[kind])[real],
            A_ub=cost[kind][real][None, :],
            b_ub=[budget],
            A_eq=each,
            b_eq=np.ones(5),
        )
        got = SharedHulls(cost, value).bound(kind, size, budget)
        assert got == pytest.approx(-float(solution.fun), rel=1e-12)
    assert SharedHulls(cost, value).bound(kind, size, 7.9) == -np.inf  # 2 · 1 + 3 · 2 = 8 at least
