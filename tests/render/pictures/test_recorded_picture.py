"""Small pictures of frames that a log keeps the levels of."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.render.pictures import scene_picture
from lodbench.render.pictures.scene_picture import draw_small
from lodbench.render.pictures.snapshot import Snapshot, recorded_snapshot, take_snapshot
from lodbench.render.pictures.triangles import rows_as_seen
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay

Made = Callable[..., Any]
FRAME = 25


def mesh_of(triangles: int, size: float = 1.0) -> LevelMesh:
    """Return a square across the view, of two triangles again and again."""
    points = size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
    normals = np.tile(np.array([[0, 0, 1]], dtype=np.float32), (4, 1))
    faces = np.tile(np.array([[0, 1, 2], [0, 2, 3]]), (triangles // 2, 1))
    return LevelMesh(points, normals, faces, np.array([0, triangles]))


@pytest.fixture
def replayed(make_hardware: Made, make_trace: Made) -> Callable[..., tuple[FrameLog, Snapshot]]:
    """Return what replays a walk with its levels kept, and takes a snapshot of the same frame."""
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, -30.0)], time_s=[0.0, 3.0])
    options = ReplayOptions(budget_ms=10.0, frames=FRAME + 1, fovy_deg=70.0)

    def run(scene: Scene, policy: str) -> tuple[FrameLog, Snapshot]:
        spec, machine = parse_policy(policy), make_hardware()
        log = replay(spec.make(), scene, trace, machine, options, name=policy, keeps_levels=True)
        return log, take_snapshot(spec, scene, trace, machine, options, FRAME)

    return run


@pytest.mark.parametrize("moves", [False, True])
def test_a_recorded_frame_is_what_was_drawn(
    replayed: Callable[..., tuple[FrameLog, Snapshot]], make_scene: Made, moves: bool
) -> None:
    """Nodes, levels, camera and places are those of a snapshot of the replay itself."""
    motion = Motion(np.array([2, 5]), np.full(2, 3.0), np.full(2, 1.5), np.zeros(2))
    more = {"motion": motion} if moves else {}
    rng = np.random.default_rng(0)
    place = np.column_stack((rng.uniform(-9, 9, (40, 2)), rng.uniform(-60, 0, 40)))
    scene = make_scene(place, **more)
    log, taken = replayed(scene, "static-distance:near_m=10,far_m=40")
    assert log.levels is not None
    shot = recorded_snapshot(scene, log, FRAME, (100, 100), 70.0)
    order = np.argsort(taken.ids)
    assert shot.ids.tolist() == taken.ids[order].tolist()
    assert shot.detail.tolist() == taken.detail[order].tolist()
    assert len(set(shot.detail.tolist())) > 1, "several levels are drawn"
    assert shot.camera.pose == pytest.approx(taken.camera.pose)
    assert shot.camera.focal_px == pytest.approx(50.0 / math.tan(math.radians(35.0)))
    assert shot.centers_m == pytest.approx(taken.centers_m)


def test_a_continuous_node_has_the_resolution_of_its_knot(
    replayed: Callable[..., tuple[FrameLog, Snapshot]], make_scene: Made, make_levels: Made
) -> None:
    """Of 1,000, 250 and 50 triangles the least is drawn, and the log keeps the knot passed, 250."""
    levels = make_levels([(1000.0, 250.0, 50.0)], continuous=True)
    scene = make_scene([(0.0, 0.0, -40.0)], levels=levels)
    log, _ = replayed(scene, "static-distance:near_m=0.1,far_m=1")
    shot = recorded_snapshot(scene, log, FRAME, (100, 100), 70.0)
    assert shot.detail.tolist() == [0.25]


def test_triangles_that_cannot_be_seen_apart_are_not_drawn(
    replayed: Callable[..., tuple[FrameLog, Snapshot]], make_scene: Made
) -> None:
    """Full detail is drawn by its own mesh near by, and by the coarsest of enough far away.

    Pictures are 100 px high, and 71 pixels wide a metre at 1 m.  At 5 m a sphere of 1 m covers 690
    pixels, at 40 m about 10, so that 20 triangles are enough: 50 are, but not 4.
    """
    scene = make_scene([(0.0, 0.0, -7.5), (2.0, 0.0, -42.5)])
    geometry = (mesh_of(1000), mesh_of(50), mesh_of(4))
    log, _ = replayed(scene, "full")
    shot = recorded_snapshot(scene, log, FRAME, (100, 100), 70.0)
    assert shot.detail.tolist() == [0.0, 0.0]
    rows, count = rows_as_seen(shot, geometry, 2.0)
    assert rows.tolist() == [0, 1]
    assert count == 1050
    assert rows_as_seen(shot, geometry, 0.1)[0].tolist() == [1, 2]


def test_a_scene_with_too_many_triangles_has_stand_ins(
    replayed: Callable[..., tuple[FrameLog, Snapshot]],
    make_scene: Made,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A picture comes out whatever the meshes: beyond the bound the one without any."""
    scene = make_scene([(0.0, 0.0, -10.0)])
    log, _ = replayed(scene, "full")
    shot = recorded_snapshot(scene, log, FRAME, (64, 36), 70.0)
    geometry = (mesh_of(1000), mesh_of(50), mesh_of(4))
    own, bare = (np.asarray(draw_small(shot, meshes)) for meshes in (geometry, ()))
    assert own.shape == (36, 64, 3)
    assert (own != bare).any()
    monkeypatch.setattr(scene_picture, "_MOST_TRIANGLES", 10)
    assert (np.asarray(draw_small(shot, geometry)) == bare).all()
