"""One variable for several leaves: which leaves, and that sharing loses no more than it may."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.solvers.allocation import allocate
from lodbench.policies.solvers.variable_splitting import LeafTree, Splitting, split_variables

Make = Callable[..., Scene]


def four_by_four(make_scene: Make) -> LeafTree:
    """Return a root over four nodes over sixteen leaves, each node's leaves together."""
    parent = [-1, 0, 0, 0, 0, *np.repeat([1, 2, 3, 4], 4).tolist()]
    scene = make_scene(np.zeros((21, 3)), parent=parent)
    return LeafTree(scene, Tree(scene), np.arange(21) >= 5)


def best(weight: Any, low: Any, high: Any, budget: float) -> Any:
    """Return the best shares of leaves by themselves."""
    return allocate(0.5 * weight, np.ones(len(weight)), budget, power=0.5, low=low, high=high).x


def lost(splitting: Splitting, weight: Any, low: Any, high: Any, budget: float) -> float:
    """Return what the best shares of variables lose against the best shares of leaves."""
    start = splitting.start
    full = np.add.reduceat(high, start)
    value = np.add.reduceat(weight * np.sqrt(high), start) / np.sqrt(full)
    lowest = np.maximum.reduceat(low / high, start) * full
    apart = float(weight @ np.sqrt(best(weight, low, high, budget)))
    return apart - float(value @ np.sqrt(best(value, lowest, full, budget)))


def test_leaves_stand_from_left_to_right(make_scene: Make) -> None:
    """Nodes in any order of ids: the leaves below each are one range, other leaves are left out."""
    parent = [-1, -1, 1, 0, 1, 2, 0, 2, 4]
    scene = make_scene(np.zeros((9, 3)), parent=parent)
    member = np.array([False, False, False, True, False, True, False, True, True])
    tree = LeafTree(scene, Tree(scene), member)
    assert tree.leaves.tolist() == [3, 5, 7, 8]
    ranges = list(zip(tree.first.tolist(), tree.stop.tolist(), strict=True))
    assert ranges[0] == (0, 1)
    assert ranges[1] == (1, 4)
    assert ranges[2] == (1, 3)
    assert ranges[4] == (3, 4)
    assert ranges[6][0] == ranges[6][1]
    assert tree.children(np.array([2, 0])).tolist() == [5, 7, 3, 6]


def test_the_criterion_by_hand(make_scene: Make) -> None:
    """Four leaves of weight 1 with a budget of 1 may lose 4 · 1 · (1 - 1/2) = 2 < ε / 4, ε > 8."""
    scene = make_scene(np.zeros((5, 3)), parent=[-1, 0, 0, 0, 0])
    tree = LeafTree(scene, Tree(scene), np.arange(5) > 0)
    weight, low, high = np.ones(4), np.zeros(4), np.full(4, 9.0)
    share = np.full(4, 0.25)
    drawn = np.ones(4, dtype=bool)
    for epsilon, start in ((8.001, [0]), (7.999, [0, 1, 2, 3])):
        found = split_variables(tree, drawn, weight, low, high, share, epsilon)
        assert found.start.tolist() == start
    whole = split_variables(tree, drawn, weight, low, high, share, 8.001)
    assert whole.loss == pytest.approx(2.0)
    assert whole.allowed == pytest.approx(8.001 / 4.0)


def test_unequal_leaves_have_a_tighter_criterion(make_scene: Make) -> None:
    """Of full costs 1 and 15 the lesser may lose all but a quarter: 2 · 1 · (1 - 1/4) = 1.5."""
    scene = make_scene(np.zeros((3, 3)), parent=[-1, 0, 0])
    tree = LeafTree(scene, Tree(scene), np.arange(3) > 0)
    weight, low, high = np.ones(2), np.zeros(2), np.array([1.0, 15.0])
    found = split_variables(tree, np.ones(2, dtype=bool), weight, low, high, np.full(2, 0.5), 100.0)
    assert found.loss == pytest.approx(1.5)


def test_a_node_that_could_not_pay_its_lowest_is_split(make_scene: Make) -> None:
    """Sharing the higher of two floors would cost 2 where 1.5 is to be spent."""
    scene = make_scene(np.zeros((3, 3)), parent=[-1, 0, 0])
    tree = LeafTree(scene, Tree(scene), np.arange(3) > 0)
    weight, low, high = np.ones(2), np.array([0.1, 1.0]), np.full(2, 4.0)
    share, drawn = np.array([0.5, 1.0]), np.ones(2, dtype=bool)
    assert len(split_variables(tree, drawn, weight, low, high, share, 1e9).start) == 2
    assert len(split_variables(tree, drawn, weight, low, high, 2.0 * share, 1e9).start) == 1


def test_only_drawn_leaves_count(make_scene: Make) -> None:
    """With five of sixteen leaves drawn, variables are places among these five."""
    tree = four_by_four(make_scene)
    drawn = np.zeros(16, dtype=bool)
    drawn[[0, 5, 6, 7, 15]] = True
    ones = np.ones(5)
    args = ones, 0.0 * ones, 9.0 * ones, 0.2 * ones
    assert split_variables(tree, drawn, *args, 0.0).start.tolist() == [0, 1, 2, 3, 4]
    assert split_variables(tree, drawn, *args, 1e9).start.tolist() == [0]
    middle = split_variables(tree, drawn, *args, 3.0 * 3.0 * np.sqrt(0.6) * 0.5)
    assert middle.start.tolist() == [0, 1, 4]
    nothing = np.zeros(0)
    none = split_variables(tree, drawn & False, nothing, nothing, nothing, nothing, 1.0)
    assert len(none.start) == 0


def test_printed_shares_of_a_nodes_sum_would_break_the_bound(make_scene: Make) -> None:
    """Weights 1, 1, 1, 1 and 4, 0, 0, 0: with X_i ∝ S_i^4 the second node loses 1.65 > 1.42.

    Its share would be a half; the leaves' own shares give it 4² / (4² + 4) = 0.8.
    """
    parent = [-1, 0, 0, *np.repeat([1, 2], 4).tolist()]
    scene = make_scene(np.zeros((11, 3)), parent=parent)
    tree = LeafTree(scene, Tree(scene), np.arange(11) >= 3)
    weight = np.array([1.0, 1.0, 1.0, 1.0, 4.0, 1e-9, 1e-9, 1e-9])
    low, high = np.zeros(8), np.full(8, 10.0)
    uneven = Splitting(np.arange(5), 0.0, 0.0, 0)
    loss = lost(uneven, weight, low, high, 1.0)
    assert loss == pytest.approx(np.sqrt(20.0) - np.sqrt(8.0), rel=1e-6)
    assert loss > 4.0 * np.sqrt(0.5) * (1.0 - 0.5)
    share = best(weight, low, high, 1.0)
    assert share[4:].sum() == pytest.approx(0.8)
    drawn = np.ones(8, dtype=bool)
    found = split_variables(tree, drawn, weight, low, high, share, 8.0)
    assert found.start.tolist() == [0, 4]
    assert found.loss == pytest.approx(4.0 * (np.sqrt(0.2) + np.sqrt(0.8)) * 0.5)
    assert loss < found.loss


@given(
    seed=st.integers(0, 2**32 - 1),
    epsilon=st.floats(0.0, 100.0),
    spread=st.floats(0.0, 3.0),
    spend=st.floats(0.001, 1.0),
    equal=st.booleans(),
)
def test_sharing_loses_no_more_than_epsilon_says(
    make_scene: Make, seed: int, epsilon: float, spread: float, spend: float, equal: bool
) -> None:
    """Loss against the best shares of leaves <= Appendix A's bound <= what ε allows.

    With leaves at both bounds, unequal costs, and budgets from next to nothing to everything.
    """
    rng = np.random.default_rng(seed)
    tree = four_by_four(make_scene)
    weight = np.exp(rng.normal(0.0, spread, 16))
    high = np.ones(16) if equal else rng.uniform(0.2, 2.0, 16)
    low = high * rng.choice([1e-3, 0.05], 16)
    budget = float(low.sum()) + spend * float((high - low).sum())
    share = best(weight, low, high, budget)
    drawn = np.ones(16, dtype=bool)
    found = split_variables(tree, drawn, weight, low, high, share, epsilon)
    actual = lost(found, weight, low, high, budget)
    rounding = 1e-9 * float(weight.sum())
    assert -rounding <= actual <= found.loss + rounding
    assert found.loss <= found.allowed
