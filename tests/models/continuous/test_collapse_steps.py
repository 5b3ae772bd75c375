"""Levels that a model can have, and the triangles between two of them, beside real index sets."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from index_set import IndexSet, change_leaves

from lodbench.models.continuous.collapse import contract
from lodbench.models.continuous.collapse_steps import CollapseSteps, triangles_changed
from lodbench.models.continuous.foliage import Leaves, collapse_leaves
from lodbench.models.continuous.knots import OrderedSurface
from lodbench.models.continuous.ordered_mesh import OrderedMesh, order_mesh
from lodbench.models.meshes.surface_mesh import SurfaceMesh
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scenes.crowd import character_mesh
from lodbench.models.scenes.ogres import ogre_mesh

MakeLevels = Callable[..., LevelTable]
SHARES = ((1.0, 0.99), (1.0, 0.9), (1.0, 0.5), (0.5, 0.45), (0.5, 0.25), (0.2, 0.15))


def law(before: int, after: int) -> float:
    """Return the triangles that should differ."""
    return float(triangles_changed(np.array([float(before)]), np.array([float(after)]))[0])


def test_levels_are_whole_collapses(make_levels: MakeLevels) -> None:
    """Of 1,000 triangles 998 are one collapse away; of a discrete type the level is its index."""
    steps = CollapseSteps(make_levels([(1000, 100), (40, 20, 10)], continuous=(True, False)))
    kind = np.array([0, 0, 0, 0, 1])
    level = steps.level(kind, np.array([1.0, 0.9991, 0.9989, 0.5, 2.0]))
    assert level.tolist() == [0.0, 0.0, 1.0, 250.0, 2.0]
    soft = kind[:4]
    assert steps.resolution(soft, level[:4]).tolist() == [1.0, 1.0, 0.998, 0.5]
    assert steps.triangles(soft, level[:4]).tolist() == [1000.0, 1000.0, 998.0, 500.0]


@given(step=st.integers(0, 900), jitter=st.floats(-1e-9, 1e-9))
def test_a_last_bit_is_no_change(make_levels: MakeLevels, step: int, jitter: float) -> None:
    """A resolution that a model can have keeps its level however it was rounded."""
    steps = CollapseSteps(make_levels([(2000, 200)], continuous=True))
    detail = np.array([1.0 - 2 * step / 2000 + jitter])
    assert steps.level(np.array([0]), detail) == [step]


def test_changes_by_hand() -> None:
    """The same set changes nothing; 100 to 50 triangles keep 50³ / 100² untouched; both ways."""
    assert law(100, 100) == law(0, 0) == 0.0
    assert law(100, 50) == law(50, 100) == 88.0  # 87.5
    assert law(0, 100) == law(100, 0) == 100.0
    assert law(10_000, 9_998) == 6.0


def test_one_collapse_of_a_closed_mesh_is_six_triangles_on_average(ball: SurfaceMesh) -> None:
    """Over the first 100 steps of the ball, one at a time."""
    mesh = order_mesh(ball.faces, contract(ball.positions[None], ball.faces))
    counted = IndexSet(mesh)
    changes = [counted.change(int(mesh.faces_after[s])).triangles_changed for s in range(1, 101)]
    assert np.mean(changes) == pytest.approx(6.0, rel=0.15)


def assert_near(mesh: OrderedMesh) -> None:
    """Assert that index sets change 0.7 to 1.1 of what the law says, coarsening and refining."""
    full, least = int(mesh.faces_after[0]), int(mesh.faces_after[-1])
    for high, low in SHARES:
        counted = IndexSet(mesh)
        counted.change(int(high * full))
        before = len(counted.faces)
        work = counted.change(max(int(low * full), least))
        after = len(counted.faces)
        assert 0.7 < work.triangles_changed / law(before, after) < 1.1, (high, low)
        assert counted.change(before).triangles_changed == work.triangles_changed


def test_the_ball_and_leaves_change_as_the_law_says(ball: SurfaceMesh) -> None:
    """A closed mesh within 30 %; leaves, of which two make way for one, up to 1.5 times as much."""
    assert_near(order_mesh(ball.faces, contract(ball.positions[None], ball.faces)))
    rng = np.random.default_rng(3)
    center, along, across = rng.normal(size=(3, 500, 3))
    foliage = collapse_leaves(Leaves(3.0 * center, 0.05 * along, 0.05 * across))
    for high, low in SHARES:
        before, after = int(high * foliage.full), int(low * foliage.full)
        counted = change_leaves(foliage, before, after).triangles_changed
        assert 0.95 < counted / law(2 * before, 2 * after) < 1.5, (high, low)


@pytest.mark.slow
def test_the_papers_models_change_as_the_law_says() -> None:
    """The ogre, and Peng's character with its seams kept."""
    assert_near(OrderedSurface.of(ogre_mesh(np.random.default_rng(2008))).ordered)
    assert_near(OrderedSurface.of(character_mesh(), keep_texture=True).ordered)
