"""Foliage: area kept by every collapse, any count of leaves, operations counted, knots."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from index_set import ExtractionWork, change_leaves

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.continuous.foliage import Foliage, Leaves, collapse_leaves, leaf_triangles
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.surface_mesh import MeshPart, clean_surface
from lodbench.models.meshes.type_model import gather_types, measure_levels


def crown(count: int, seed: int = 0) -> Leaves:
    """Return leaves of 16 by 6 cm, turned at random, in a ball of radius 2 m."""
    rng = np.random.default_rng(seed)
    center = rng.normal(size=(count, 3))
    center *= 2.0 * rng.random((count, 1)) ** (1 / 3) / np.linalg.norm(center, axis=1)[:, None]
    along = rng.normal(size=(count, 3))
    across = np.cross(along, rng.normal(size=(count, 3)))
    along, across = (v / np.linalg.norm(v, axis=1)[:, None] for v in (along, across))
    return Leaves(center, 0.08 * along, 0.03 * across)


@pytest.fixture(scope="module")
def foliage() -> Foliage:
    """Return a crown of 400 leaves, collapsed to one."""
    return collapse_leaves(crown(400))


def test_two_leaves_side_by_side_become_one() -> None:
    """Two squares that share an edge become the rectangle of both."""
    leaves = Leaves(
        np.array([(0.0, 0.0, 1.0), (2.0, 0.0, 1.0)]),
        np.array([(1.0, 0.0, 0.0)] * 2),
        np.array([(0.0, 1.0, 0.0)] * 2),
    )
    one = collapse_leaves(leaves).leaves.at(np.array([2]))
    assert one.center_m[0] == pytest.approx([1.0, 0.0, 1.0])
    assert np.abs(one.along_m[0]) == pytest.approx([2.0, 0.0, 0.0])
    assert np.abs(one.across_m[0]) == pytest.approx([0.0, 1.0, 0.0])
    assert one.area_m2[0] == pytest.approx(8.0)


def test_alike_leaves_go_first() -> None:
    """Of four leaves at equal distances the two that are parallel collapse first."""
    across = np.array([(0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 0)], dtype=float)
    along = np.array([(1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    center = np.array([(0, 0, 0), (3, 0, 0), (3, 3, 0), (0, 3, 0)], dtype=float)
    foliage = collapse_leaves(Leaves(center, along, across), least=3)
    assert foliage.died.tolist() == [0, 0, 1, 1, 1]


@settings(max_examples=25, deadline=None)
@given(count=st.integers(1, 60), seed=st.integers(0, 9), data=st.data())
def test_any_count_is_delivered_and_area_kept(count: int, seed: int, data: st.DataObject) -> None:
    """Every count down to one leaf can be had, and covers what all leaves do."""
    leaves = crown(count, seed)
    foliage = collapse_leaves(leaves)
    wanted = data.draw(st.integers(1, count))
    rows = foliage.extract(wanted)
    assert len(rows) == wanted
    assert foliage.leaves.at(rows).area_m2.sum() == pytest.approx(leaves.area_m2.sum())


def test_centre_of_area_is_kept(foliage: Foliage) -> None:
    """The mean of the leaves by area stays where it is."""
    means: list[np.ndarray] = []
    for count in (400, 100, 7, 1):
        leaves = foliage.leaves.at(foliage.extract(count))
        means.append(np.average(leaves.center_m, axis=0, weights=leaves.area_m2))
    assert np.ptp(means, axis=0) == pytest.approx(np.zeros(3), abs=1e-9)


def test_operations_are_counted(foliage: Foliage) -> None:
    """A collapse removes two leaves and writes one; undone, it writes two."""
    assert change_leaves(foliage, 400, 399) == ExtractionWork(6, 6, 3)
    assert change_leaves(foliage, 399, 400) == ExtractionWork(6, 12, 3)
    assert change_leaves(foliage, 50, 50) == ExtractionWork(0, 0, 0)


def test_triangles_of_leaves_have_their_area() -> None:
    """Two triangles a leaf, together of its area, wound alike."""
    leaves = crown(5)
    points, faces = leaf_triangles(leaves)
    a, b, c = (points[faces[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    area = 0.5 * np.linalg.norm(cross, axis=1).reshape(-1, 2).sum(axis=1)
    assert area == pytest.approx(leaves.area_m2)
    assert (np.einsum("ij,ij->i", cross[::2], cross[1::2]) > 0.0).all()


def test_a_type_of_knots(foliage: Foliage) -> None:
    """Foliage is measured as any levels: errors rise from 0, and a table holds them."""
    counts = (400, 220, 121, 66, 36, 20)
    drawn = [leaf_triangles(foliage.leaves.at(foliage.extract(count))) for count in counts]
    surfaces = [clean_surface("tree", [MeshPart(*triangles)]) for triangles in drawn]
    model = measure_levels(surfaces, Sampling(400, 400), continuous=True)
    triangles = model.counts[:, LEVEL_PREDICTORS.index("triangles")]
    assert triangles[[0, -1]].tolist() == [800, 40]
    assert (model.counts[:, LEVEL_PREDICTORS.index("vertices")] == 2 * triangles).all()
    assert model.error_m[0] == 0.0
    assert 0.05 < model.error_m[1] <= model.error_m[-1] < 4.0
    types, geometry = gather_types([model])
    assert types.levels.continuous.tolist() == [True]
    assert len(geometry) == 6


@pytest.mark.parametrize("count", [0, 401, -1])
def test_counts_out_of_range_are_refused(foliage: Foliage, count: int) -> None:
    """There are 1 to 400 leaves to be had."""
    with pytest.raises(InputError, match=f"expected 1 to 400, got {count}"):
        foliage.extract(count)


def test_leaves_without_area_are_refused() -> None:
    """No leaves, a leaf that is a line, a leaf that is not finite, and a least that is none."""
    line = np.array([(1.0, 0.0, 0.0)])
    with pytest.raises(InputError, match="each with an area"):
        Leaves(np.zeros((1, 3)), line, line)
    with pytest.raises(InputError, match="at least one"):
        Leaves(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)))
    with pytest.raises(InputError, match="expected finite values"):
        Leaves(np.full((1, 3), np.nan), line, np.array([(0.0, 1.0, 0.0)]))
    with pytest.raises(InputError, match="least: expected 1 to 3"):
        collapse_leaves(crown(3), least=4)
