"""Where cameras move in the bundled scenes: over the ground, through doors, along streets."""

import math

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.analysis.study.stages import Stage, find_stage
from lodbench.base.arrays import BoolArray
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.models.scenes.atlas import build_atlas
from lodbench.models.scenes.soda_hall import build_soda_hall
from lodbench.models.scenes.styria import CELL_M, build_styria, styria_heights
from lodbench.traces.cameras.camera_trace import CameraTrace


def test_other_scenes_have_the_box_about_them(small_scene: Scene) -> None:
    """Ground at the foot of the box, as large as the box, and no way."""
    middle, size = scene_extent(small_scene)
    stage = find_stage(small_scene)
    assert stage.ground_m == pytest.approx((*middle[:2], middle[2] - size[2] / 2.0))
    assert stage.plan_m == pytest.approx(size[:2])
    assert stage.way_m is None


@pytest.mark.slow
def test_paths_in_the_building() -> None:
    """Walk and drive go the same way through rooms and corridors, the drive ten times as fast."""
    scene, _ = build_soda_hall()
    cells = scene.cells
    assert cells is not None
    walk, drive = load_trace("walk", scene), load_trace("drive", scene)
    assert drive.position_m[:180] == pytest.approx(walk.position_m[:1800:10], abs=1e-6)
    rooms = {cells.cell_at(tuple(point)) for point in drive.position_m.tolist()}
    assert len(rooms) > 5
    assert len(cells.low_m) not in rooms  # never outside
    assert (load_trace("tour", scene).position_m[:, 2] == 1.65).all()


@pytest.mark.slow
def test_an_orbit_sees_nearly_the_whole_city() -> None:
    """All but two of 114 walls are in view from everywhere on it, as in the thesis' fly-through."""
    scene = load_scene("city")
    trace = load_trace("orbit", scene)
    for second in np.linspace(0.0, trace.duration_s, 7).tolist():
        pose = trace.pose_at(second)
        camera = Camera(pose.position_m, pose.orientation_xyzw, 1024, 768, math.radians(60.0))
        x, y, z = camera.to_camera(scene.center_m[scene.roots].T)
        assert (z > 100.0).all()
        wide = np.abs(x) * camera.focal_px / z < 512.0
        assert np.count_nonzero(~(wide & (np.abs(y) * camera.focal_px / z < 384.0))) <= 2


@pytest.mark.slow
def test_paths_over_mountains() -> None:
    """Nothing goes below the ground; on foot and by car the eye keeps its height above it."""
    scene, _ = build_styria()
    heights = styria_heights()
    for kind, low, high in (("walk", 1.0, 2.5), ("drive", 0.8, 2.0), ("fly-over", 500.0, 3_000.0)):
        trace = load_trace(kind, scene)
        x, y, z = trace.position_m.T
        column, row = x / CELL_M, y / CELL_M
        nearest = heights[row.round().astype(int), column.round().astype(int)]
        slope = np.abs(np.diff(heights, axis=0)).max()
        assert (z - nearest).min() > low - slope
        assert (z - nearest).max() < high + slope
    step = np.linalg.norm(np.diff(load_trace("fly-over", scene).position_m, axis=0), axis=1)
    assert 100.0 < step.max() * 60.0 <= 251.0
    for kind in ("tour", "sudden-turn", "orbit"):
        assert load_trace(kind, scene).position_m[:, 2].min() > heights.max()


@pytest.mark.slow
def test_the_detector_stands_on_the_ground() -> None:
    """Eyes are 1.65 m above the floor, not above the foot of a bounding sphere."""
    scene, _ = build_atlas()
    assert load_trace("tour", scene).position_m[0, 2] == pytest.approx(1.65)


def in_view(scene: Scene, trace: CameraTrace, time_s: float) -> BoolArray:
    """Return which spheres meet the frustum of a screen of 16:9, 60 degrees high, (N,)."""
    pose = trace.pose_at(time_s)
    camera = Camera(pose.position_m, pose.orientation_xyzw, 1920, 1080, math.radians(60.0))
    right, up, forward = camera.to_camera(np.ascontiguousarray(scene.center_m.T))
    inside = forward > -scene.radius_m
    for across, pixels in ((right, 1920), (up, 1080)):
        slope = pixels / 2.0 / camera.focal_px
        inside &= np.abs(across) <= forward * slope + scene.radius_m * math.hypot(1.0, slope)
    return inside


def test_a_trial_meets_little_and_much_and_never_nothing(small_scene: Scene) -> None:
    """By frustum culling, every tenth of a second: something, and at times three times as much."""
    for seed in range(1, 13):
        trace = find_stage(small_scene).move("trial", 12.0, seed)
        seen = [in_view(small_scene, trace, t).sum() for t in np.arange(0.0, 12.0, 0.1).tolist()]
        assert min(seen) > 0
        assert max(seen) > 3 * min(seen)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plaza", "district", "crowd-512", "atlas", "city", "market"])
def test_trials_of_bundled_scenes_are_never_empty(name: str) -> None:
    """Full detail has at most a tenth of its greatest load somewhere on each path, never none."""
    scene = load_scene(name)
    leaf = np.diff(scene.child_start) == 0
    finest = scene.types.levels.counts[scene.types.levels.start[:-1], 2][scene.type_index] * leaf
    for seed in range(1, 7):
        trace = find_stage(scene).move("trial", 12.0, seed)
        views = [in_view(scene, trace, t) & leaf for t in np.arange(0.0, 12.0, 0.25).tolist()]
        assert min(int(view.sum()) for view in views) > 0
        load = [float(finest[view].sum()) for view in views]
        assert min(load) < 0.1 * max(load)


def test_ways_differ_by_seed() -> None:
    """Starts all round, both directions, speeds of 0.7 to 1; seed 0 starts where the way does."""
    way = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0], [0.0, 0.0]])
    stage = Stage((50.0, 50.0, 0.0), (100.0, 100.0), way)
    plain = stage.move("drive", 10.0)
    assert plain.name == "drive"
    assert plain.position_m[0, :2] == pytest.approx([0.0, 0.0])
    speeds, areas = list[float](), list[float]()
    starts = set[tuple[int, ...]]()
    for seed in range(1, 25):
        x, y = stage.move("drive", 10.0, seed).position_m[:, :2].T
        speeds.append(float(np.median(np.hypot(np.diff(x), np.diff(y)))) * 60.0)
        # Twice the area that a line from the middle sweeps: above 0 counter-clockwise.
        areas.append(float(np.sum((x[:-1] - 50) * np.diff(y) - (y[:-1] - 50) * np.diff(x))))
        starts.add((int(x[0] // 25), int(y[0] // 25)))
    assert 0.69 * 14.0 < min(speeds) < 0.8 * 14.0
    assert 0.9 * 14.0 < max(speeds) < 1.01 * 14.0
    assert min(areas) < 0.0 < max(areas)
    assert len(starts) > 6
