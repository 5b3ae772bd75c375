"""Splat trees: budgets met exactly, area kept, median splits, and the type of a group."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.continuous.splat_tree import SplatTree, splat_levels


def plant(count: int, seed: int = 0) -> SplatTree:
    """Return a tree over leaves at random."""
    rng = np.random.default_rng(seed)
    return SplatTree.of(rng.normal(size=(count, 3)), rng.uniform(0.5, 1.5, count))


def test_four_leaves_by_hand() -> None:
    """Two pairs far apart in x: two splats stand at their middles, one in the middle of all."""
    leaves = np.array([(10.0, 1.0, 0.0), (0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    tree = SplatTree.of(leaves, np.full(4, np.pi))
    assert tree.draw(2).center_m.tolist() == [[0.0, 0.5, 0.0], [10.0, 0.5, 0.0]]
    assert tree.draw(2).radius_m == pytest.approx([np.sqrt(2.0)] * 2)
    assert tree.error_m(tree.draw(2)) == pytest.approx(0.5)
    assert tree.draw(1).center_m.tolist() == [[5.0, 0.5, 0.0]]
    # Of three, the second branch gets two: the budget's larger half goes to the larger half.
    assert tree.draw(3).start.tolist() == [0, 2, 3, 4]


@settings(max_examples=60, deadline=None)
@given(count=st.integers(1, 200), budget=st.integers(1, 300), seed=st.integers(0, 5))
def test_budgets_are_met_exactly(count: int, budget: int, seed: int) -> None:
    """As many splats as the budget allows, one a leaf at most; each leaf has one; area is kept."""
    tree = plant(count, seed)
    splats = tree.draw(budget)
    assert len(splats.center_m) == min(budget, count)
    assert splats.start[[0, -1]].tolist() == [0, count]
    assert (np.diff(splats.start) > 0).all()
    assert (np.pi * splats.radius_m**2).sum() == pytest.approx(tree.area_m2.sum())


def test_splits_are_at_the_median_of_the_longest_axis() -> None:
    """Along the longest axis every leaf of the first half lies below every one of the second."""
    tree = plant(64)

    def check(leaves: np.ndarray) -> None:
        if len(leaves) > 1:
            axis = int(np.ptp(leaves, axis=0).argmax())
            first, second = leaves[: len(leaves) // 2], leaves[len(leaves) // 2 :]
            assert first[:, axis].max() <= second[:, axis].min()
            check(first)
            check(second)

    check(tree.position_m)


def test_a_splat_a_leaf_is_exact() -> None:
    """With the full budget nothing is off, and a coarser budget errs."""
    tree = plant(100)
    assert tree.error_m(tree.draw(100)) == 0.0
    assert 0.0 < tree.error_m(tree.draw(50)) < tree.error_m(tree.draw(2))


def test_levels_of_a_group() -> None:
    """A group of 16 trees is 16 draws from 16 × 512 splats to one a tree, then fewer trees."""
    table = splat_levels(plant(512), knots=5, trees=16)
    splats = table.counts[:, LEVEL_PREDICTORS.index("splats")]
    draws = table.counts[:, LEVEL_PREDICTORS.index("draw_calls")]
    assert splats[[0, -2, -1]].tolist() == [16 * 512, 16, 1]
    assert draws.tolist() == [16] * 5 + [1]
    assert table.error_m[0] == 0.0
    assert table.error_m[-1] > table.error_m[-2]
    assert table.continuous.tolist() == [True]
    assert table.min_resolution[0] == pytest.approx(1 / (16 * 512))


@pytest.mark.parametrize(("splats", "trees"), [(40, 16), (16, 16), (11, 11), (1, 1)])
def test_a_fraction_of_a_group(splats: int, trees: int) -> None:
    """Below a splat a tree there are as many trees as splats."""
    table = splat_levels(plant(512), knots=5, trees=16)
    row, part = table.position(np.zeros(1, dtype=np.int32), np.array([splats / (16.0 * 512.0)]))
    counts = table.interpolate(table.counts, row, part)[0]
    assert counts[LEVEL_PREDICTORS.index("splats")] == pytest.approx(splats)
    assert counts[LEVEL_PREDICTORS.index("draw_calls")] == pytest.approx(trees)


def test_a_tree_by_itself_has_no_fraction() -> None:
    """Its coarsest level is one splat."""
    table = splat_levels(plant(512), knots=5)
    assert table.min_resolution[0] == pytest.approx(1 / 512)


def test_bad_input_is_refused() -> None:
    """No leaf, a leaf nowhere, one without area, no budget, too few knots."""
    for position, area in (
        (np.zeros((0, 3)), np.zeros(0)),
        (np.full((1, 3), np.inf), np.ones(1)),
        (np.zeros((1, 3)), np.zeros(1)),
        (np.zeros((2, 3)), np.ones(1)),
    ):
        with pytest.raises(InputError, match="expected"):
            SplatTree.of(position, area)
    with pytest.raises(InputError, match="budget: expected at least one splat, got 0"):
        plant(3).draw(0)
    with pytest.raises(InputError, match="at least 2 knots and 1 tree, got 1 and 0"):
        splat_levels(plant(3), knots=1, trees=0)
