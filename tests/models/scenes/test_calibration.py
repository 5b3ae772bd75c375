"""The scenes that machines are calibrated on: large triangles near by, and ones below a pixel."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.meshes.surface_mesh import SurfaceMesh
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.calibration import build_calibration_dense, build_calibration_near
from lodbench.models.scenes.parts import calibration_meshes
from lodbench.models.scenes.scene_registry import SCENES

TRIANGLES = LEVEL_PREDICTORS.index("triangles")
Built = tuple[Scene, Geometry]


@pytest.fixture(scope="module")
def near() -> Built:
    """Build the scene of large triangles."""
    return build_calibration_near()


@pytest.fixture(scope="module")
def dense() -> Built:
    """Build the scene of small ones."""
    return build_calibration_dense()


def check_as_told(built: Built) -> None:
    """As many objects and triangles as `list scenes` says, flat, discrete, with a mesh a level."""
    scene, geometry = built
    levels = scene.types.levels
    assert scene.flat
    assert scene.motion is None
    assert not levels.continuous.any()
    finest = levels.counts[levels.start[:-1], TRIANGLES]
    about = SCENES.find(scene.name).about
    named = [int(n.replace(",", "")) for n in re.findall(r"[\d,]*\d", about)]
    assert named == [len(scene), finest.min(), finest.max()]
    assert len(set(np.bincount(scene.type_index).tolist())) == 1
    sizes = [len(mesh.faces) for mesh in geometry]
    assert sizes == levels.counts[:, TRIANGLES].astype(int).tolist()


def mean_triangle_px2(built: Built, away_m: float, height_px: int) -> list[float]:
    """Return the mean area of each type's finest triangles that face the eye at right angles."""
    scene, geometry = built
    px_per_m = height_px / 2.0 / np.tan(np.radians(30.0)) / away_m
    areas: list[float] = []
    finest: list[int] = scene.types.levels.start[:-1].tolist()
    for row in finest:
        a, b, c = (geometry[row].vertices[geometry[row].faces[:, i]] for i in range(3))
        area_m2 = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        areas.append(float(area_m2.mean()) * px_per_m**2)
    return areas


def test_near_is_of_few_large_triangles(near: Built) -> None:
    """At 20 m on a screen 720 px high a triangle covers hundreds of pixels, whatever the type."""
    check_as_told(near)
    assert near[0].types.levels.level_count.tolist() == [4] * 4
    assert min(mean_triangle_px2(near, 20.0, 720)) > 200.0


def test_near_tells_draws_and_textures_apart(near: Built) -> None:
    """Types differ in draws for an object and in the share of triangles with a texture."""
    levels = near[0].types.levels
    finest = levels.counts[levels.start[:-1]]
    assert set(finest[:, LEVEL_PREDICTORS.index("draw_calls")].tolist()) == {1.0, 2.0}
    assert (finest[:, LEVEL_PREDICTORS.index("textured_triangles")] > 0.0).sum() == 1


@pytest.mark.slow
def test_dense_triangles_are_below_a_pixel(dense: Built) -> None:
    """At 30 m, half across, on a screen 720 px high the finest of each type cover less than one."""
    check_as_told(dense)
    assert max(mean_triangle_px2(dense, 30.0, 720)) < 1.0


@pytest.mark.slow
def test_dense_ladders_are_real_levels(dense: Built) -> None:
    """Seven levels, each about half the finer one, errors that rise but lose no limb early."""
    levels = dense[0].types.levels
    assert levels.level_count.tolist() == [7] * 6
    for kind, radius in enumerate(dense[0].types.radius_m):
        rows = slice(levels.start[kind], levels.start[kind + 1])
        ratio = levels.counts[rows, TRIANGLES][1:] / levels.counts[rows, TRIANGLES][:-1]
        assert ((ratio > 0.4) & (ratio < 0.6)).all()
        error = levels.error_m[rows]
        assert error[0] == 0.0
        assert (error[1:] > 0.0).all()
        assert error[3] < 0.06 * radius
        assert error[-1] < 0.3 * radius


@pytest.mark.slow
def test_shapes_are_unlike(dense: Built) -> None:
    """Vertices over triangles, and the share of the bounding disc, differ between the types."""
    scene, geometry = dense
    rows: list[int] = scene.types.levels.start[:-1].tolist()
    open_edges = [2 * len(geometry[row].vertices) - len(geometry[row].faces) for row in rows]
    # 2 V − F is twice Euler's number of a closed surface: 4 for a ball, 0 for a torus.
    assert open_edges[0] == 4
    assert (open_edges[1], open_edges[4]) == (0, 0)
    assert min(open_edges[2], open_edges[3], open_edges[5]) > 200
    assert np.ptp(scene.types.disc_share) > 0.2


@pytest.mark.parametrize(
    "make",
    [
        calibration_meshes.wall_mesh,
        calibration_meshes.board_mesh,
        calibration_meshes.pylon_mesh,
        calibration_meshes.crag_mesh,
        calibration_meshes.pebble_mesh,
        calibration_meshes.ring_mesh,
        calibration_meshes.urn_mesh,
        calibration_meshes.hill_mesh,
        calibration_meshes.knot_mesh,
        calibration_meshes.coral_mesh,
    ],
)
def test_meshes_are_what_their_docstrings_say(
    make: Callable[[np.random.Generator], SurfaceMesh],
) -> None:
    """As tall and of exactly as many triangles, whatever the noise."""
    for seed in (0, 7):
        mesh = make(np.random.default_rng(seed))
        said = re.search(r"([\d.]+) m tall.*: ([\d,]+) triangles", make.__doc__ or "")
        assert said is not None
        assert np.ptp(mesh.positions[:, 2]) == pytest.approx(float(said[1]))
        assert len(mesh.faces) == int(said[2].replace(",", ""))


def test_every_build_is_the_same(near: Built) -> None:
    """What was calibrated on can be drawn again; both scenes are built by one function."""
    scene, geometry = build_calibration_near()
    assert np.array_equal(scene.center_m, near[0].center_m)
    for mesh, before in zip(geometry, near[1], strict=True):
        assert np.array_equal(mesh.faces, before.faces)
        assert np.array_equal(mesh.vertices, before.vertices)
