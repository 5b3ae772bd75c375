"""Culling of spheres against brute force over points of the frustum."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.frustum import Culler
from lodbench.models.scene.motion import Centers, Motion
from lodbench.models.scene.sphere_blocks import SphereBlocks

coordinate = st.floats(-30.0, 30.0)
angle = st.floats(-math.pi, math.pi)


def turned(yaw: float, pitch: float) -> tuple[float, float, float, float]:
    """Return the quaternion of a turn about z after one about x."""
    cz, sz = math.cos(yaw / 2), math.sin(yaw / 2)
    cx, sx = math.cos(pitch / 2), math.sin(pitch / 2)
    return (cz * sx, sz * sx, sz * cx, cz * cx)


def build_culler(
    centers_m: np.ndarray, radius_m: np.ndarray, motion: Motion | None = None
) -> tuple[Centers, Culler]:
    """Return (3, n) centres and what culls them."""
    moving = () if motion is None else motion.node
    rests = np.setdiff1d(np.arange(len(radius_m)), moving)
    centers = Centers(centers_m.T, motion)
    return centers, Culler(centers, radius_m, SphereBlocks(centers_m.T, radius_m, rests))


def cull(
    centers_m: np.ndarray, radius_m: np.ndarray, camera: Camera
) -> tuple[np.ndarray, np.ndarray]:
    """Return ids and camera coordinates of those of some spheres at rest that are in view."""
    centers, culler = build_culler(centers_m, radius_m)
    return culler.cull(centers.at(0.0), camera)


def margin_m(centers_m: np.ndarray, radius_m: np.ndarray, camera: Camera) -> np.ndarray:
    """Return how far each sphere reaches inwards of the plane that it reaches least, (n,)."""
    half_x = math.atan(0.5 * camera.width_px / camera.focal_px)
    half_y = math.atan(0.5 * camera.height_px / camera.focal_px)
    normals = np.array(
        [
            (-math.cos(half_x), 0, math.sin(half_x)),
            (math.cos(half_x), 0, math.sin(half_x)),
            (0, -math.cos(half_y), math.sin(half_y)),
            (0, math.cos(half_y), math.sin(half_y)),
            (0, 0, 1),
        ]
    )
    signed = normals @ camera.to_camera(centers_m)
    signed[4] -= camera.near_m
    return (signed + radius_m).min(axis=0)


def frustum_points(camera: Camera, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return (3, count) random scene points inside a camera's frustum, up to 60 m deep."""
    depth = rng.uniform(camera.near_m, 60.0, count)
    across = rng.uniform(-1.0, 1.0, (2, count))
    half = np.array([[camera.width_px], [camera.height_px]]) / (2.0 * camera.focal_px)
    local = np.vstack([across * half * depth, depth])
    return camera.axes.T @ local + np.array(camera.position_m)[:, None]


@given(
    st.lists(st.tuples(coordinate, coordinate, coordinate, st.floats(0.01, 20.0)), min_size=1),
    st.tuples(coordinate, coordinate, coordinate),
    angle,
    angle,
    st.sampled_from([(1280, 720), (500, 900)]),
    st.integers(0, 2**31),
)
def test_no_sphere_in_view_is_dropped(
    spheres: list[tuple[float, float, float, float]],
    position: tuple[float, float, float],
    yaw: float,
    pitch: float,
    size_px: tuple[int, int],
    seed: int,
) -> None:
    """A sphere that holds any of 300 random points of the frustum is a candidate."""
    camera = Camera(position, turned(yaw, pitch), *size_px, math.radians(60.0))
    rows = np.array(spheres).T
    centers_m, radius_m = np.ascontiguousarray(rows[:3]), np.ascontiguousarray(rows[3])
    centers, culler = build_culler(centers_m, radius_m)
    ids, xyz_m = culler.cull(centers.at(0.0), camera)
    points = frustum_points(camera, 300, np.random.default_rng(seed))
    gap = np.linalg.norm(points[:, :, None] - centers_m[:, None, :], axis=0) - radius_m
    seen = set(np.flatnonzero((gap <= 0.0).any(axis=0)).tolist())
    assert seen <= set(ids.tolist())
    assert np.flatnonzero(culler.inside).tolist() == ids.tolist()
    assert xyz_m == pytest.approx(camera.to_camera(centers_m[:, ids]), abs=1e-9)


@given(
    st.lists(st.tuples(coordinate, coordinate, coordinate, st.floats(0.01, 20.0)), min_size=1),
    angle,
    angle,
)
def test_spheres_outside_a_plane_are_dropped(
    spheres: list[tuple[float, float, float, float]], yaw: float, pitch: float
) -> None:
    """A candidate lies outside none of the five planes, by signed distances to their normals."""
    camera = Camera((1.0, -2.0, 0.5), turned(yaw, pitch), 1280, 720, math.radians(60.0))
    rows = np.array(spheres).T
    centers_m, radius_m = np.ascontiguousarray(rows[:3]), np.ascontiguousarray(rows[3])
    ids, _ = cull(centers_m, radius_m, camera)
    margin = margin_m(centers_m, radius_m, camera)
    clear = np.abs(margin) > 1e-9
    expected = np.flatnonzero((margin > 0.0) & clear)
    assert set(expected.tolist()) == set(ids[clear[ids]].tolist())


def test_boundaries_by_hand() -> None:
    """With 90 degrees, spheres of 1 m at 10 m depth are in view up to 10 + sqrt 2 m aside."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 100, 100, math.pi / 2)
    reach = 10.0 + math.sqrt(2.0)
    centers = [
        (reach - 1e-6, 0, -10),
        (reach + 1e-6, 0, -10),
        (0, -reach + 1e-6, -10),
        (0, -reach - 1e-6, -10),
        (0, 0, 0.9 - 1e-6),  # its front reaches just beyond the near plane at 0.1 m
        (0, 0, 0.9 + 1e-6),
        (0, 0, -1e6),  # no far plane
    ]
    ids, _ = cull(np.array(centers, dtype=np.float64).T, np.ones(7), camera)
    assert ids.tolist() == [0, 2, 4, 6]
    assert ids.dtype == np.int32


@pytest.mark.parametrize("count", [1, 63, 64, 65, 40_000])
def test_blocks_make_no_difference(count: int) -> None:
    """Many spheres are culled as each would be alone, in ascending order."""
    rng = np.random.default_rng(count)
    camera = Camera((0.0, 0.0, 0.0), turned(0.3, 1.2), 640, 480, 1.0)
    centers_m, radius_m = rng.uniform(-50, 50, (3, count)), rng.uniform(0.1, 3.0, count)
    ids, xyz_m = cull(centers_m, radius_m, camera)
    some = rng.integers(0, count, 50)
    for node in some:
        alone, _ = cull(centers_m[:, [node]], radius_m[[node]], camera)
        assert (len(alone) == 1) == (node in ids)
    assert (np.diff(ids) > 0).all()
    assert xyz_m.shape == (3, len(ids))


@given(st.data())
def test_a_walk_through_blocks_gives_what_planes_give(data: st.DataObject) -> None:
    """Frame after frame the candidates are those that the planes alone give, in ascending order.

    Spheres are small, as large as the scene, around the camera, on circles, or just touch a plane
    of the first frame; the camera steps, jumps and turns, so that blocks come and go.
    """
    rng = np.random.default_rng(data.draw(st.integers(0, 2**31)))
    count = data.draw(st.integers(1, 700))
    side_m = data.draw(st.sampled_from((1.0, 30.0, 400.0)))
    centers_m = rng.uniform(-side_m, side_m, (3, count)) * [
        [1.0],
        [1.0],
        [data.draw(st.sampled_from((0.0, 1.0)))],
    ]
    radius_m = side_m * 10.0 ** rng.uniform(-4.0, data.draw(st.sampled_from((-2.0, 1.0))), count)
    camera = Camera((0.0, 0.0, 0.0), turned(0.3, 1.2), 640, 480, 1.0)
    touching = rng.random(count) < 0.2
    gap_m = margin_m(centers_m, np.zeros(count), camera)
    touching &= gap_m < -1e-3 * side_m
    radius_m[touching] = -gap_m[touching] * (1.0 + rng.choice((-1e-7, 1e-7), int(touching.sum())))
    moves = rng.permutation(count)[: data.draw(st.integers(0, count))]
    circles = rng.uniform(0.0, 1.0, (3, len(moves))) * [[side_m], [2.0], [6.0]]
    centers, culler = build_culler(centers_m, radius_m, Motion(moves, *circles))
    step_m = data.draw(st.sampled_from((0.0, 0.002, 0.3))) * side_m
    for frame in range(6):
        now = centers.at(0.1 * frame)
        ids, xyz_m = culler.cull(now, camera)
        margin = margin_m(now.all_m, radius_m, camera)
        clear = np.abs(margin) > 1e-9 * side_m
        assert ((margin >= 0.0) == culler.inside)[clear].all()
        assert ids.tolist() == np.flatnonzero(culler.inside).tolist()
        expected_m = camera.to_camera(now.all_m[:, ids])
        assert xyz_m == pytest.approx(expected_m, rel=1e-12, abs=1e-12 * side_m)
        position = tuple(rng.uniform(-step_m, step_m, 3) + camera.position_m)
        yaw, pitch = rng.uniform(-1.0, 1.0, 2) * step_m / side_m * 6.0
        camera = Camera(position, turned(0.3 + yaw, 1.2 + pitch), 640, 480, 1.0)


def test_the_answer_is_read_only() -> None:
    """Nobody can change which nodes the simulator takes to be in view."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 100, 100, 1.0)
    centers, culler = build_culler(np.array([[0.0], [0.0], [-5.0]]), np.ones(1))
    ids, xyz_m = culler.cull(centers.at(0.0), camera)
    for array in (ids, xyz_m, culler.inside):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_candidates_that_stay_are_the_same_array() -> None:
    """Ids are one array while the same spheres are in view, and what was handed out stays."""
    centers, culler = build_culler(np.array([[0.0, 0.0], [0.0, 0.0], [-5.0, 9.0]]), np.ones(2))
    now, ahead, back = centers.at(0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.0)
    first, first_xyz_m = culler.cull(now, Camera((0.0, 0.0, 0.0), ahead, 100, 100, 1.5))
    again, again_xyz_m = culler.cull(now, Camera((-1.0, 0.0, 0.0), ahead, 100, 100, 1.5))
    assert again is first
    other, _ = culler.cull(now, Camera((0.0, 0.0, 0.0), back, 100, 100, 1.5))
    assert (first.tolist(), other.tolist()) == ([0], [1])
    assert first_xyz_m.ravel().tolist() == [0.0, 0.0, 5.0]
    assert again_xyz_m.ravel().tolist() == [1.0, 0.0, 5.0]
