"""Replays of players who share a screen: what each adds to what the others cost and see."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.content_hash import content_hash
from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.rig import Eyes
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Policy
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import UNLOGGED, FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.shared_screen import split, together
from lodbench.traces.cameras.vary import vary

BACK = (0.0, 1.0, 0.0, 0.0)  # half a turn about the vertical: looks along +z
AHEAD = [(0.4 * x, 0.3 * x, -6.0 - 2.0 * x) for x in range(6)]
BEHIND = [(0.2 * x, 0.0, 8.0 + x) for x in range(4)]
PRICED = {"draw_calls": 0.01, "triangles": 1e-3, "shaded_samples": 1e-3, "state_changes": 0.25}


@pytest.fixture
def play(
    make_scene: Callable[..., Scene], make_hardware: Callable[..., HardwareProfile]
) -> Callable[..., FrameLog]:
    """Return a function that replays one path in a scene with objects ahead of it and behind."""

    def played(
        policy: str | Policy,
        path: CameraTrace,
        positions: Any = (*AHEAD, *BEHIND),
        linear: dict[str, float] | None = None,
        eyes: Eyes | None = None,
        **display: Any,
    ) -> FrameLog:
        return replay(
            parse_policy(policy).make() if isinstance(policy, str) else policy,
            make_scene(positions),
            path,
            make_hardware(PRICED if linear is None else linear, **display),
            ReplayOptions(budget_ms=8.0, fovy_deg=90.0, frames=4, eyes=eyes),
            name="policy",
        )

    return played


@pytest.fixture
def ahead(make_trace: Callable[..., CameraTrace]) -> CameraTrace:
    """Return a player who walks ahead for a second."""
    return make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, -0.5)])


@pytest.mark.parametrize("policy", ["static-screen", "feedback", "gobbetti", "zach", "hoppe"])
def test_a_player_who_sees_nothing_changes_nothing(
    play: Callable[..., FrameLog],
    ahead: CameraTrace,
    make_trace: Callable[..., CameraTrace],
    policy: str,
) -> None:
    """Beside one who turns his back on all objects, the first plays as on half a screen of his own.

    He stands among them, so that a distance or an area of his would change what is chosen.
    """
    blind = make_trace([(0.0, 0.0, -4.0)] * 2, orientation_xyzw=BACK)
    two = play(policy, together([ahead, blind]), AHEAD)
    one = play(policy, ahead, AHEAD, height_px=50)
    assert one["drawn"].min() > 0
    for name in one.columns:
        np.testing.assert_allclose(two[name], one[name], rtol=1e-12, err_msg=name)


def test_two_players_cost_what_each_costs_alone(
    play: Callable[..., FrameLog], ahead: CameraTrace, make_trace: Callable[..., CameraTrace]
) -> None:
    """Who look at different halves of a scene share the base of a frame, and nothing else."""
    behind = make_trace([(0.0, 0.0, 1.0)] * 2, orientation_xyzw=BACK)
    # Without costs that would shift the times at which the players are where they are.
    first, second = (play("full", path, linear={}, height_px=50) for path in (ahead, behind))
    both = play("full", together([ahead, behind]), linear={})
    for name in {*LEVEL_PREDICTORS, "shaded_samples", "state_changes", "visible"} - {*UNLOGGED}:
        np.testing.assert_allclose(both[name], first[name] + second[name], err_msg=name)
    assert first["visible"][0] == 6
    assert second["visible"][0] == 4


def test_pixels_are_those_of_the_screen(play: Callable[..., FrameLog], ahead: CameraTrace) -> None:
    """Two and four players share all of it, and three leave a quarter of it dark."""
    for players, share in ((1, 1.0), (2, 1.0), (3, 0.75), (4, 1.0)):
        log = play("full", together([ahead] * players), linear={"framebuffer_pixels": 1e-4})
        assert log["model_gpu_ms"][0] == pytest.approx(1.0 + share)


def test_each_player_is_culled_for_himself(
    play: Callable[..., FrameLog],
    ahead: CameraTrace,
    make_hardware: Callable[..., HardwareProfile],
    make_scene: Callable[..., Scene],
) -> None:
    """Of ten objects, two players test twenty, and two eyes of one of them ten."""
    hardware = make_hardware({}, cpu={"objects_culled": 0.1})
    for path, eyes, culled in (
        (ahead, None, 10),
        (together([ahead] * 2), None, 20),
        (ahead, Eyes(apart_m=0.1), 10),
    ):
        options = ReplayOptions(budget_ms=8.0, frames=1, eyes=eyes)
        scene = make_scene((*AHEAD, *BEHIND))
        log = replay(parse_policy("full").make(), scene, path, hardware, options, name="full")
        assert log["cpu_ms"][0] == pytest.approx(0.5 + 0.1 * culled)


def test_paths_are_cut_to_the_shortest(make_trace: Callable[..., CameraTrace]) -> None:
    """The screen is shared from the beginning to where the first player's path ends."""
    long, short = (
        make_trace([(float(x), 0.0, 0.0) for x in range(5)]),
        make_trace([(0.0, 0.0, 0.0)] * 3),
    )
    path = together([long, short])
    assert path.duration_s == 2.0
    assert [player.duration_s for player in split(path)] == [2.0, 2.0]
    later = path.stretch(0.5, 1.5)
    assert [player.pose_at(0.0).position_m[0] for player in split(later)] == [0.5, 0.0]
    assert later.duration_s == 1.0


def test_a_shared_screen_is_another_path(ahead: CameraTrace) -> None:
    """By its hash, by which runs are found again; it travels whole, and all players vary."""
    alone, both = content_hash(ahead), together([ahead, ahead])
    assert content_hash(both) not in {alone, content_hash(together([ahead] * 3))}
    sent = pickle.loads(pickle.dumps(both))
    assert content_hash(sent) == content_hash(both)
    first, second = split(vary(both, 3))
    assert first.duration_s == second.duration_s == both.duration_s
    assert first.pose_at(0.5) != second.pose_at(0.5)


def test_too_many_players_are_refused(ahead: CameraTrace) -> None:
    """And players within players."""
    for paths in ([ahead] * 5, [], [ahead, together([ahead] * 2)]):
        with pytest.raises(InputError, match="expected 1 to 4 paths of one player each"):
            together(paths)


def test_players_have_one_eye_each(ahead: CameraTrace, play: Callable[..., FrameLog]) -> None:
    """Headsets that share a screen are nobody's; to drop either in silence is a wrong cost."""
    with pytest.raises(InputError, match="expected one player with two eyes, got 2 who share"):
        play("full", together([ahead] * 2), eyes=Eyes(apart_m=0.1))
