"""`static-distance` held to three.js' own `LOD.update` on the same camera path."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lodbench.analysis.study.inputs import load_trace
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.selection import Selection
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay

pytestmark = [pytest.mark.peer, pytest.mark.slow]

NEAR_M, FAR_M = 20.0, 300.0
FRAMES = 1_200
RunPeer = Callable[[str, dict[str, Any]], Any]
Walk = Callable[..., tuple[list[float], list[float]]]


class Noted(StaticDistance):
    """The policy, which notes where the camera was and what it chose."""

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget what was noted."""
        super().reset(scene, budget_ms)
        self.cameras: list[tuple[float, float, float]] = []
        self.levels: list[NDArray[np.float64]] = []  # -1 of objects out of view

    def select(self, view: View) -> Selection:
        """Return what the policy does."""
        selection = super().select(view)
        levels = np.full(len(view.scene), -1.0)
        levels[selection.ids] = selection.detail
        self.cameras.append(view.camera.position_m)
        self.levels.append(levels)
        return selection


def objects_of(scene: Scene, near_m: float, far_m: float, hysteresis: float) -> list[Any]:
    """Return objects as three.js is given them: each level from a distance on."""
    levels: list[int] = np.diff(scene.types.levels.start)[scene.type_index].tolist()
    step_m = far_m - near_m
    return [
        {
            "position": center,
            "distances": [0.0, *(near_m + step_m * i / count for i in range(1, count))],
            "hysteresis": hysteresis,
        }
        for center, count in zip(scene.center_m.tolist(), levels, strict=True)
    ]


def along_a_path(run_peer: RunPeer, hysteresis: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return our levels and three.js' of all objects of `district`, (frames, objects)."""
    scene = load_scene("district")
    policy = Noted(NEAR_M, FAR_M, hysteresis)
    replay(
        policy,
        scene,
        load_trace("trial", scene),
        load_hardware("desktop-assumed"),
        ReplayOptions(budget_ms=16.0, frames=FRAMES),
        name="noted",
    )
    objects = objects_of(scene, NEAR_M, FAR_M, hysteresis)
    theirs = run_peer(
        "three_lod.mjs", {"objects": objects, "cameras": policy.cameras, "begin": "hidden"}
    )
    return np.array(policy.levels), np.array(theirs)


@pytest.fixture
def walk(
    run_peer: RunPeer,
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
) -> Walk:
    """Return our levels and three.js' of one object of four levels, ahead at these distances."""

    def walked(
        distances_m: Sequence[float], hysteresis: float, begin: str = "hidden"
    ) -> tuple[list[float], list[float]]:
        scene = make_scene([(0.0, 0.0, 0.0)], levels=make_levels([(100, 50, 25, 12)]))
        policy, detail = StaticDistance(10.0, 90.0, hysteresis), np.nan
        policy.reset(scene, 10.0)
        ours: list[float] = []
        for distance_m in distances_m:
            camera = Camera((0.0, 0.0, distance_m), (0.0, 0.0, 0.0, 1.0), 100, 100, 1.5)
            detail = float(policy.select(make_view(scene, camera, detail=detail)).detail[0])
            ours.append(detail)
        asked = {
            "objects": objects_of(scene, 10.0, 90.0, hysteresis),
            "cameras": [(0.0, 0.0, distance_m) for distance_m in distances_m],
            "begin": begin,
        }
        return ours, [row[0] for row in run_peer("three_lod.mjs", asked)]

    return walked


def test_without_hysteresis_every_level_is_three_js(run_peer: RunPeer) -> None:
    """In 20 s of a trial through `district` no object in view has another level."""
    ours, theirs = along_a_path(run_peer, 0.0)
    seen = ours >= 0.0
    assert seen.sum() > 10_000
    assert len(np.unique(ours[seen])) == 7
    assert (ours == theirs)[seen].all()


def test_with_hysteresis_only_what_was_out_of_view_differs(run_peer: RunPeer) -> None:
    """three.js updates objects out of view too; ours knows of them what it last drew, or nothing.

    So a level may differ of an object that came into view, until it next crosses a threshold: of
    those that have been in view since the start none does, and of all in view 1 % at most.
    """
    ours, theirs = along_a_path(run_peer, 0.1)
    seen = ours >= 0.0
    never_left = np.logical_and.accumulate(seen, axis=0)
    differs = (ours != theirs) & seen
    assert not (differs & never_left).any()
    print(f"{differs.sum()} of {seen.sum()} levels differ, {differs.sum() / seen.sum():.2%}")
    assert 0 < differs.sum() < 0.01 * seen.sum()


@pytest.mark.parametrize("hysteresis", [0.05, 0.1, 0.3, 0.6])
def test_one_object_that_comes_and_goes(walk: Walk, hysteresis: float) -> None:
    """Steps and jumps over 800 frames; at 0.6 bands overlap: levels are given up two at once."""
    rng = np.random.default_rng(3)
    steps = rng.normal(0.0, 4.0, 800) + (rng.random(800) < 0.02) * rng.normal(0.0, 60.0, 800)
    distances_m = (5.0 + np.abs(np.cumsum(steps)) % 110.0).tolist()
    ours, theirs = walk(distances_m, hysteresis)
    assert ours == theirs
    assert set(ours) == {0.0, 1.0, 2.0, 3.0}
    plain, _ = walk(distances_m, 0.0)
    assert ours != plain


def test_three_js_begins_with_every_level_visible(walk: Walk) -> None:
    """48 m is before the threshold of 50: three.js lowers it at first, as if it had been beyond.

    Ours draws level 1, since nothing was drawn before.  From 30 m on both agree.
    """
    ours, theirs = walk([48.0, 48.0, 31.0, 48.0], 0.1, "visible")
    assert ours == [1, 1, 1, 1]
    assert theirs == [2, 2, 1, 1]
