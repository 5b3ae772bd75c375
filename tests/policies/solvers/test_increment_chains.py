"""Increments of rows that stand by themselves, compared with the forest that sorts them all."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.falling_cut import FallingCut
from lodbench.policies.solvers.increment_chains import IncrementChains
from lodbench.policies.solvers.increment_forest import IncrementForest
from lodbench.policies.solvers.mixed_selection import raise_in_turn
from lodbench.policies.solvers.smooth_ascent import NewtonAscent

Pair = tuple[IncrementForest, IncrementChains]


def make_pair(rng: np.random.Generator, cut: FallingCut, rows: int, columns: int) -> Pair:
    """Return the same increments as a forest and as chains; rows are of several lengths."""
    cost = rng.integers(1, 60, (rows, columns)).astype(float)
    gain = cost * rng.integers(1, 30, (rows, columns)).astype(float)
    void = np.arange(columns) >= rng.integers(0, columns + 1, (rows, 1))
    ratio = np.minimum.accumulate(gain / cost, axis=1)
    ratio[void] = -1.0
    forest = IncrementForest(cost, gain, void, np.full(rows, -1), np.array([0, rows]))
    return forest, IncrementChains(cost, ratio, cut)


@given(seed=st.integers(0, 10_000), rows=st.integers(0, 60), columns=st.integers(1, 5))
def test_the_same_is_taken_in_as_many_steps(seed: int, rows: int, columns: int) -> None:
    """From frame to frame within budgets from nothing to plenty; whole numbers tie often."""
    rng, cut = np.random.default_rng(seed), FallingCut()
    for budget in (200.0, 210.0, 1.0, 5_000.0, 190.0, 0.0):
        forest, chains = make_pair(rng, cut, rows, columns)
        nothing = np.zeros(0)
        ends = [
            raise_in_turn(each, NewtonAscent(nothing, nothing, nothing), budget, 100)
            for each in (forest, chains)
        ]
        assert ends[0] == ends[1]
        assert chains.count == forest.count
        assert chains.taken.tolist() == forest.taken.tolist()


@given(seed=st.integers(0, 10_000), rows=st.integers(1, 40))
def test_portions_down_to_a_slope_are_the_same(seed: int, rows: int) -> None:
    """Also where something else takes turns, and the order has to be known."""
    rng = np.random.default_rng(seed)
    forest, chains = make_pair(rng, FallingCut(), rows, 3)
    left = 300.0
    for least in (20.0, 12.0, 5.0, 0.0, 0.0):
        assert chains.slope(left) == forest.slope(left)
        assert chains.ahead(left) == forest.ahead(left)
        spent = forest.take(least, left)
        assert chains.take(least, left) == pytest.approx(spent)
        left -= spent
    assert chains.taken.tolist() == forest.taken.tolist()
