"""Styria: heights, trees in groups, and the layout that Zach's policy expects."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.models.scene.tree import Tree
from lodbench.models.scenes import styria
from lodbench.models.scenes.parts.forest_groups import MOST_IN_GROUP, group_trees
from lodbench.models.scenes.styria import build_styria, styria_heights


@settings(max_examples=30)
@given(st.integers(1, 3_000), st.integers(0, 2**32 - 1))
def test_groups_hold_all_trees(count: int, seed: int) -> None:
    """No group is empty or above 64; spheres hold their trees; parents stand first."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(0.0, 1_000.0, (count, 3)) ** rng.uniform(0.3, 1.0)
    groups = group_trees(place, 1_000.0)
    leaf = np.bincount(groups.parent[groups.parent >= 0], minlength=len(groups.parent)) == 0
    assert groups.trees.sum() == count
    assert (groups.trees[leaf] > 0).all()
    assert (groups.trees[~leaf] == 0).all()
    assert groups.trees.max() <= MOST_IN_GROUP
    assert (groups.parent < np.arange(len(groups.parent))).all()
    held = np.linalg.norm(place[:, None] - groups.center_m[None], axis=2) <= groups.radius_m
    assert held[:, 0].all()
    assert (held.sum(axis=1) >= 1).all()
    assert (held[:, leaf].sum(axis=0) >= groups.trees[leaf]).all()


@pytest.mark.slow
def test_heights() -> None:
    """2,049² of them, from valleys to the Alps, the same every time."""
    heights = styria_heights()
    assert heights.shape == (2_049, 2_049)
    assert heights.min() == pytest.approx(250.0, abs=50.0)
    assert 1_800.0 < heights.max() < 3_000.0
    assert np.array_equal(heights, styria_heights())


def test_trees_stand_on_a_jittered_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """On flat forest each of 100 by 100 cells has its tree, but for one in a hundred."""
    monkeypatch.setattr(styria, "_TREES", 9_900)
    heights = np.full((2_049, 2_049), 1_000.0)
    place = styria._plant(heights, np.random.default_rng(0))  # pyright: ignore[reportPrivateUsage]
    assert place.shape == (9_900, 3)
    assert place[:, 2] == pytest.approx(1_000.0)
    cell = np.floor(place[:, :2] / (styria.WIDTH_M / 100.0)).astype(np.int64)
    assert np.unique(cell @ (1, 1_000)).size == 9_900


@pytest.mark.slow
def test_the_whole_province() -> None:
    """1.4 million trees in groups of at most 64, beside 5,461 patches of terrain."""
    scene, geometry = build_styria()
    assert geometry == ()
    tree = Tree(scene)
    finest = scene.types.levels.counts[scene.types.levels.start[:-1]][scene.type_index]
    groups = scene.continuous
    assert finest[groups, 0].sum() == 1_400_000.0
    assert finest[groups, 0].max() <= 64.0
    assert (tree.leaf[groups]).all()
    assert (finest[groups, 5] == 512.0 * finest[groups, 0]).all()
    assert (finest[~groups & (finest[:, 2] == 0.0), 0] == 0.0).all()
    patches = finest[:, 2] > 0.0
    assert patches.sum() == sum(4**d for d in range(7))
    assert (finest[patches, 1] == 32.0 * 2.0 * 33.0).all()  # sent in 32 strips
    assert len(scene.roots) == 2
    assert np.ptp(scene.center_m[patches, :2], axis=0).min() > 110_000.0
