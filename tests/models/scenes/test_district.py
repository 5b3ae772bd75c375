"""The district: dense meshes, whose levels are real ones, on a plan with little and much load."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.meshes.surface_mesh import SurfaceMesh
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.district import build_district
from lodbench.models.scenes.parts import district_meshes
from lodbench.models.scenes.scene_registry import SCENES

TRIANGLES = LEVEL_PREDICTORS.index("triangles")


@pytest.fixture(scope="module")
def district() -> tuple[Scene, Geometry]:
    """Return the scene and its geometry."""
    return build_district()


def test_as_it_is_told(district: tuple[Scene, Geometry]) -> None:
    """As many objects as `list scenes` says, of seven types of 20,480 to 58,800 triangles."""
    scene, _ = district
    named = [int(n) for n in re.findall(r"\d+", SCENES.find("district").about)]
    assert named == [len(scene)]
    assert len(scene.types.names) == 7
    levels = scene.types.levels
    finest = levels.counts[levels.start[:-1], TRIANGLES]
    assert (finest.min(), finest.max()) == (20_480, 58_800)
    assert levels.level_count.tolist() == [7] * 7
    assert not levels.continuous.any()


def test_levels_are_meshes_that_halve_and_err_more(district: tuple[Scene, Geometry]) -> None:
    """Each has the triangles that its row counts, about half the finer one's, and a sane error."""
    scene, geometry = district
    levels = scene.types.levels
    sizes = [len(mesh.faces) for mesh in geometry]
    assert sizes == levels.counts[:, TRIANGLES].astype(int).tolist()
    for kind, radius in enumerate(scene.types.radius_m):
        rows = slice(levels.start[kind], levels.start[kind + 1])
        ratio = levels.counts[rows, TRIANGLES][1:] / levels.counts[rows, TRIANGLES][:-1]
        assert ((ratio > 0.4) & (ratio < 0.6)).all()
        error = levels.error_m[rows]
        assert error[0] == 0.0
        assert (error[1:] > 0.0).all()
        # A level that lost a wall or a limb errs by about the radius.
        assert error[-2] < 0.25 * radius
        assert error[-1] < 0.5 * radius


def test_nothing_overlaps(district: tuple[Scene, Geometry]) -> None:
    """No two bounding circles meet within a region, and each stands on the ground."""
    scene, _ = district
    gap = np.linalg.norm(scene.center_m[:, None, :2] - scene.center_m[None, :, :2], axis=2)
    np.fill_diagonal(gap, np.inf)
    assert (gap - scene.radius_m[:, None] - scene.radius_m[None]).min() > -1e-6
    assert (scene.position_m[:, 2] == 0.0).all()


def test_load_begins_at_the_edge_of_the_park(district: tuple[Scene, Geometry]) -> None:
    """West of x = -190 an area holds less than a third of the triangles of the same area beyond."""
    scene, _ = district
    finest = scene.types.levels.counts[scene.types.levels.start[:-1], TRIANGLES]
    x, triangles = scene.center_m[:, 0], finest[scene.type_index]
    park = triangles[(x > -350.0) & (x < -190.0)].sum()
    beyond = triangles[(x > -190.0) & (x < -30.0)].sum()
    assert 0.0 < park < beyond / 3.0


@pytest.mark.parametrize(
    "make",
    [
        district_meshes.tower_mesh,
        district_meshes.house_mesh,
        district_meshes.chapel_mesh,
        district_meshes.fountain_mesh,
        district_meshes.statue_mesh,
        district_meshes.tree_mesh,
        district_meshes.boulder_mesh,
    ],
)
def test_meshes_are_what_their_docstrings_say(
    make: Callable[[np.random.Generator], SurfaceMesh],
) -> None:
    """As tall and of as many triangles, to the thousand, as the docstring says."""
    mesh = make(np.random.default_rng(0))
    said = re.search(r"(\d+) m tall.*: ([\d,]+) triangles", make.__doc__ or "")
    assert said is not None
    assert np.ptp(mesh.positions[:, 2]) == pytest.approx(float(said[1]))
    assert len(mesh.faces) == pytest.approx(int(said[2].replace(",", "")), abs=600)


@pytest.mark.slow
def test_two_builds_are_the_same(district: tuple[Scene, Geometry]) -> None:
    """What one process caches, another would have made."""
    build_district.cache_clear()
    scene, geometry = build_district()
    assert np.array_equal(scene.center_m, district[0].center_m)
    assert np.array_equal(scene.types.levels.error_m, district[0].types.levels.error_m)
    for mesh, before in zip(geometry, district[1], strict=True):
        assert np.array_equal(mesh.faces, before.faces)
