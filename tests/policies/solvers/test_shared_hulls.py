"""Hulls that objects share, compared with a hull an object."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from lodbench.policies.solvers.knapsack import (
    affordable,
    best_single,
    hull_increments,
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
