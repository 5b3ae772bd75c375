"""Snapshots of a replay and their pictures."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.render.pictures.scene_picture import draw_snapshot, write_picture
from lodbench.render.pictures.snapshot import take_snapshot
from lodbench.render.pictures.triangles import fineness, node_triangles
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

OPTIONS = ReplayOptions(budget_ms=10.0, frames=6)


def square(size: float) -> LevelMesh:
    """Return a square across the view, of two triangles."""
    points = size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
    normals = np.tile(np.array([[0, 0, 1]], dtype=np.float32), (4, 1))
    return LevelMesh(points, normals, np.array([[0, 1, 2], [0, 2, 3]]), np.array([0, 2]))


@pytest.fixture
def take(
    make_hardware: Callable[..., HardwareProfile], make_trace: Callable[..., CameraTrace]
) -> Callable[..., Any]:
    """Return what takes a snapshot of frame 5 from the origin, looking along -z."""

    def shoot(scene: Scene, policy: str = "full", frame: int = 5, **options: Any) -> Any:
        trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], time_s=[0.0, 9.0])
        wanted = ReplayOptions(budget_ms=10.0, frames=frame + 1, **options)
        return take_snapshot(parse_policy(policy), scene, trace, make_hardware(), wanted, frame)

    return shoot


def test_a_snapshot_is_what_the_replay_drew(
    take: Callable[..., Any],
    make_scene: Callable[..., Scene],
    make_hardware: Callable[..., HardwareProfile],
    make_trace: Callable[..., CameraTrace],
) -> None:
    """As many nodes as the frame log says, under a policy, and under one that sees the future."""
    rng = np.random.default_rng(0)
    scene = make_scene(np.column_stack((rng.uniform(-9, 9, (40, 2)), rng.uniform(-40, 0, 40))))
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], time_s=[0.0, 9.0])
    for name in ("static-screen", "oracle"):
        shot = take(scene, name)
        policy = parse_policy(name).make()
        log = replay(policy, scene, trace, make_hardware(), OPTIONS, name=name)
        assert len(shot.ids) == log["drawn"][5] > 0
        assert shot.frame == 5


def test_a_policy_that_does_not_fit_is_refused(
    take: Callable[..., Any], make_scene: Callable[..., Scene]
) -> None:
    """With the reason."""
    with pytest.raises(InputError, match="hlod-hysteresis: expected a policy that fits"):
        take(make_scene(np.zeros((1, 3))), "hlod-hysteresis")


def test_fineness_of_levels_and_resolutions(
    take: Callable[..., Any],
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
) -> None:
    """Levels 0 of three are 1, the coarsest resolution is 0, roots are coarse and leaves fine."""
    place = np.array([[0.0, 0.0, -20.0], [2.0, 0.0, -30.0]])
    assert fineness(take(make_scene(place))).tolist() == [1.0, 1.0]
    soft = make_scene(place, levels=make_levels([(1000.0, 100.0)], continuous=True))
    coarse = take(soft, "static-distance:near_m=0.1,far_m=1")
    assert fineness(coarse) == pytest.approx([0.0, 0.0], abs=1e-6)
    tree = make_scene(place, parent=[-1, 0], levels=make_levels([(10.0,)]))
    shot = take(tree, "screen-space-error:tolerance_px=1e6")
    assert fineness(shot).tolist() == [0.0]


def test_a_node_is_seen_where_it_stands(
    take: Callable[..., Any], make_scene: Callable[..., Scene], make_levels: Callable[..., Any]
) -> None:
    """A square 10 m ahead and 4 m up fills the pixels that its projection says.

    A view of 60 degrees, 100 pixels high: 86.6 pixels a metre at 1 m, so 8.66 at 10 m.
    """
    scene = make_scene(np.array([[0.0, 4.0, -10.0]]), levels=make_levels([(2.0,)]))
    shot = take(scene)
    picture = np.asarray(draw_snapshot(shot, (square(1.0),))).astype(int)
    empty = np.asarray(draw_snapshot(take(make_scene(np.array([[0, 0, 9.0]]))), ())).astype(int)
    row, column = np.nonzero(np.abs(picture - empty).sum(axis=2)[:70] > 30)
    assert column.min() == pytest.approx(50 - 8.66, abs=1.0)
    assert column.max() + 1 == pytest.approx(50 + 8.66, abs=1.0)
    assert row.min() == pytest.approx(50 - 5 * 8.66, abs=1.0)
    assert row.max() + 1 == pytest.approx(50 - 3 * 8.66, abs=1.0)
    # Finest is the yellow end of the ramp.
    red, green, blue = picture[15, 50]
    assert red > green > 3 * blue


@pytest.mark.parametrize("flat", [True, False])
def test_scenes_without_meshes_have_stand_ins(
    flat: bool,
    take: Callable[..., Any],
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., Any],
) -> None:
    """Octahedra within the spheres of objects, squares over those of nodes of a tree."""
    place = np.array([[0.0, 0.0, -20.0], [1.0, 0.0, -20.0], [-1.0, 0.0, -20.0]])
    tree = {} if flat else {"parent": [-1, 0, 0]}
    shot = take(
        make_scene(place, levels=make_levels([(5.0,)]), **tree),
        "full" if flat else "screen-space-error:tolerance_px=0.001",
    )
    ((corner, node),) = node_triangles(shot, ())
    assert set(node.tolist()) == set(range(len(shot.ids)))
    gap = np.abs(corner[:, :, 0] - shot.scene.center_m[shot.ids][node][:, None, 0])
    assert gap.max() <= 1.0 + 1e-9
    assert draw_snapshot(shot, ()).size == (100, 100)


def test_a_picture_is_written_whole(
    take: Callable[..., Any], make_scene: Callable[..., Scene], tmp_path: Path
) -> None:
    """A PNG and nothing beside it."""
    write_picture(tmp_path / "a.png", draw_snapshot(take(make_scene(np.array([[0, 0, -9.0]]))), ()))
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
