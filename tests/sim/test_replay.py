"""Replays as a whole: motion, ends, options, failures, determinism, conservation."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError, PolicyError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Selection
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeScene = Callable[..., Scene]
MakeHardware = Callable[..., HardwareProfile]
MakeTrace = Callable[..., CameraTrace]


def test_moving_objects_move(run: Run, make_scene: MakeScene, make_hardware: MakeHardware) -> None:
    """A node that circles out of view is culled while it is out, after half a turn of 2 s."""
    motion = Motion(np.array([0]), np.array([40.0]), np.array([math.pi]), np.array([0.0]))
    scene = make_scene([(0.0, 0.0, -10.0)], motion=motion)
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=500.0)
    log = run(Full(), 5, scene=scene, hardware=hardware)
    assert log["visible"].tolist() == [1, 0, 0, 0, 1]


def test_apparent_speed_of_a_moving_node(
    run: Run, scripted: MakePolicy, make_scene: MakeScene, make_hardware: MakeHardware
) -> None:
    """Passing at 1 m/s and 10 m, a node turns by atan(0.1 / 10) in 0.1 s, camera at rest."""
    motion = Motion(np.array([0]), np.array([1.0]), np.array([1.0]), np.array([0.5 * math.pi]))
    scene = make_scene([(0.0, 0.0, -10.0)], motion=motion)
    seen: list[float] = []

    def watch(view: View, selection: Selection) -> Selection:
        seen.extend(view.speed_deg_s)
        return selection

    run(scripted([0], watch), 2, scene=scene, hardware=make_hardware({}, cpu_base_ms=100.0))
    offset = motion.offset_m(0.1)[:, 0]
    angle = math.degrees(math.atan2(math.hypot(offset[0], offset[1]), 10.0))
    assert seen == pytest.approx([0.0, angle / 0.1])


def test_the_time_since_the_last_frame_is_told(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """On frames of 100 ms a policy hears 0 first, and then 0.1 s each, not the time so far."""
    steps: list[float] = []

    def watch(view: View, selection: Selection) -> Selection:
        steps.append(view.state.step_s)
        return selection

    run(scripted([0], watch), 4, hardware=make_hardware({}, base_ms=1e-6, cpu_base_ms=100.0))
    assert steps == pytest.approx([0.0, 0.1, 0.1, 0.1])


def test_predictions_are_noted(run: Run, scripted: MakePolicy) -> None:
    """What a policy predicts stands beside what the frame took."""
    assert run(scripted([0], predicted_ms=1.75))["predicted_gpu_ms"][0] == 1.75


def test_posterior_draws_play_the_truth(run: Run, make_hardware: MakeHardware) -> None:
    """A draw that the profile does not have is refused before any frame."""
    with pytest.raises(InputError, match="has 0 draws"):
        run(Full(), hardware=make_hardware(), options={"draw": 0})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"budget_ms": 0.0}, "budget: expected milliseconds > 0"),
        ({"budget_ms": math.nan}, "budget: expected milliseconds > 0"),
        ({"frames": 0}, "frames: expected 1 to"),
        ({"crossfade_ms": -1.0}, "crossfade: expected milliseconds >= 0"),
        ({"measurement_delay": 17}, "measurement delay: expected 0 to 16"),
        ({"seed": -1}, "seed: expected a whole number >= 0"),
    ],
)
def test_impossible_options_are_refused(options: dict[str, Any], message: str) -> None:
    """Each option says what it expects."""
    with pytest.raises(InputError, match=message):
        replace(ReplayOptions(budget_ms=1.0), **options)


def test_a_replay_ends_with_its_trace(
    make_scene: MakeScene, make_hardware: MakeHardware, make_trace: MakeTrace
) -> None:
    """A trace of 1 s and frames of 0.25 s of CPU give inputs at 0 to 1 s, the end included."""
    trace = make_trace([(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)])
    hardware = make_hardware({}, cpu_base_ms=250.0)
    options = ReplayOptions(budget_ms=10.0)
    log = replay(Full(), make_scene([(0, 0, -10.0)]), trace, hardware, options, name="full")
    assert log["x_m"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_a_policy_that_raises_fails_by_name_and_frame(run: Run, scripted: MakePolicy) -> None:
    """What went wrong is told in one line, with the policy's name and the frame."""

    def fail(view: View, selection: Selection) -> Selection:
        if view.frame == 3:
            message = "no such\n  level"
            raise KeyError(message)
        return selection

    with pytest.raises(PolicyError) as caught:
        run(scripted([0], fail), 5)
    assert str(caught.value) == r"policy scripted, frame 3: KeyError: 'no such\n level'"
    assert (caught.value.policy, caught.value.frame) == ("scripted", 3)


def test_a_policy_that_cannot_be_reset_fails_by_name(run: Run) -> None:
    """An error before the first frame is the policy's too."""
    with pytest.raises(PolicyError, match="policy scripted, reset: InputError: static-distance"):
        run(StaticDistance(near_m=5.0, far_m=1.0))


def test_a_selection_that_breaks_the_contract_fails_the_policy(
    run: Run, scripted: MakePolicy
) -> None:
    """A level that the type does not have ends the replay, and is not repaired."""
    with pytest.raises(PolicyError, match=r"frame 1: detail of node 0: .*0 to 2, got 3"):
        run(scripted([0, 3]), 5)


def test_policies_cannot_write_to_what_they_see(run: Run, scripted: MakePolicy) -> None:
    """Every array of a view is read-only, so that no policy changes what is counted."""
    names = (
        "ids", "xyz_m", "type_index", "radius_m", "distance_m", "nearest_m", "area_px",
        "eccentricity_deg", "speed_deg_s", "previous_detail", "inside", "resident",
    )  # fmt: skip

    def write(view: View, selection: Selection) -> Selection:
        completed = view.completed
        arrays = [getattr(view, name) for name in names]
        arrays += [view.state.last_detail, view.state.inside, view.state.centers_m]
        arrays += [completed.work_ms, completed.present_ms, view.camera.axes]
        for array in arrays:
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0
        return selection

    assert len(run(scripted([0], write), 4)) == 4


def test_a_trace_that_would_not_end_is_refused_before_and_at_its_pace(
    make_scene: MakeScene,
    make_hardware: MakeHardware,
    make_trace: MakeTrace,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At 60 Hz 47 hours are too many frames; so are 40 hours, when frames are seen to take 1 ms.

    That is known when the pace is looked at first, and half of the 144 million frames is told.
    """
    monkeypatch.setattr("lodbench.sim.policy_frames._PACE_FRAMES", 100)
    scene, options = make_scene([(0, 0, -10.0)]), ReplayOptions(budget_ms=10.0)

    def replayed(hours: int, cpu_base_ms: float, frames: int | None = None) -> int:
        poses = [(float(hour), 0.0, 0.0) for hour in range(hours + 1)]
        short = make_trace(poses)
        trace = replace(short, time_s=3600.0 * short.time_s)
        hardware = make_hardware({}, cpu_base_ms=cpu_base_ms)
        limited = replace(options, frames=frames)
        return len(replay(Full(), scene, trace, hardware, limited, name="full"))

    with pytest.raises(InputError, match=r"expected at most 10000000 frames, got 1.02e\+07;"):
        replayed(47, 250.0)
    assert replayed(47, 250.0, frames=3) == 3
    with pytest.raises(InputError, match=r"expected at most 10000000 frames, got 7[.]\d+e\+07;"):
        replayed(40, 0.01)
