"""Test policies that are shown a predicted pose."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.rig import Eyes
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.predictive import Predictive, extrapolate
from lodbench.policies.protocol import Capabilities, Policy
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

Make = Callable[..., Any]
DISTANCE = "static-distance+near_m=0+far_m=64"


def camera(x_m: float, turn_deg: float, sign: float = 1.0) -> Camera:
    """Return a camera at x, turned to the left about the vertical y of its own frame."""
    half = np.radians(turn_deg) / 2.0
    orientation = (0.0, sign * float(np.sin(half)), 0.0, sign * float(np.cos(half)))
    return Camera((x_m, 0.0, 0.0), orientation, 100, 100, np.pi / 2)


@given(
    turn_deg=st.floats(-170.0, 170.0),
    ahead=st.floats(0.0, 4.0),
    sign=st.sampled_from([1.0, -1.0]),
    start_deg=st.floats(-180.0, 180.0),
)
def test_constant_motion_is_extrapolated_exactly(
    turn_deg: float, ahead: float, sign: float, start_deg: float
) -> None:
    """Any turn and step of 3 m, continued, whatever the sign of the quaternions."""
    seen = extrapolate(camera(1.0, start_deg), camera(4.0, start_deg + turn_deg, sign), ahead)
    expected = camera(4.0 + 3.0 * ahead, start_deg + turn_deg * (1.0 + ahead))
    assert seen.position_m == pytest.approx(expected.position_m)
    assert seen.axes == pytest.approx(expected.axes, abs=1e-9)


@pytest.fixture(scope="module")
def line(make_scene: Make, make_levels: Make) -> Scene:
    """Return objects ahead every metre to 60 m, of 64 levels, so a level is a metre."""
    position_m = np.column_stack((np.zeros(60), np.zeros(60), -np.arange(1.0, 61.0)))
    return make_scene(position_m, levels=make_levels([np.arange(64, 0, -1)]), radius_m=0.1)


def levels_of(policy: Predictive, view: View) -> np.ndarray:
    """Return the levels of a view's objects."""
    selection: Selection = policy.select(view)
    assert selection.ids is view.ids
    return selection.detail


def test_the_policy_decides_on_the_predicted_pose(line: Scene, make_view: Make) -> None:
    """Going 1 m in 100 ms, half a second ahead every object is 5 m nearer: 5 levels finer."""
    policy = Predictive(DISTANCE, horizon_ms=500.0)
    policy.reset(line, 10.0)
    here, before = camera(0.0, 0.0), Camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 100, 100, 1.5)
    view = make_view(line, here, previous_camera=before, step_s=0.1)
    plain = StaticDistance(near_m=0.0, far_m=64.0)
    plain.reset(line, 10.0)
    expected = np.abs(plain.select(view).detail - 5.0)  # those nearer than 5 m lie behind then
    assert levels_of(policy, view)[5:].tolist() == expected[5:].tolist()
    assert view.camera is here


def test_the_horizon_follows_the_frames_under_way(line: Scene, make_view: Make) -> None:
    """With 2 frames not completed, a frame is expected after 3 intervals: 3 m nearer."""
    policy = Predictive(DISTANCE)
    policy.reset(line, 10.0)
    before = Camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2)
    view = make_view(
        line, camera(0.0, 0.0), previous_camera=before, step_s=0.1, work_ms=[5.0] * 4, frame=6
    )
    assert levels_of(policy, view)[10] == 11.0 - 3.0


def test_a_cut_is_not_continued(line: Scene, make_view: Make) -> None:
    """A jump of 30 m or of half a turn in a frame leaves the pose as it is."""
    for before in (
        Camera((0.0, 0.0, 30.0), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2),
        camera(0.0, 179.0),
    ):
        policy = Predictive(DISTANCE, horizon_ms=100.0)
        policy.reset(line, 10.0)
        view = make_view(line, camera(0.0, 0.0), previous_camera=before, step_s=0.016)
        assert levels_of(policy, view).tolist() == list(range(1, 61))


def test_the_first_frame_has_no_past(line: Scene, make_view: Make) -> None:
    """Without a previous camera the pose is the sampled one."""
    policy = Predictive(DISTANCE)
    policy.reset(line, 10.0)
    assert levels_of(policy, make_view(line, camera(0.0, 0.0))).tolist() == list(range(1, 61))


def test_naming_the_inner_policy() -> None:
    """A plus stands for the colon and the commas; its errors are those of the inner policy."""
    made = parse_policy("predictive:policy=funkhouser+mode=greedy+skip=on,horizon_ms=40").make()
    assert isinstance(made, Predictive)
    assert made.horizon_ms == 40.0
    inner: Any = made._inner  # pyright: ignore[reportPrivateUsage] - what the name stands for
    assert (inner.mode, inner.skip) == ("greedy", True)
    with pytest.raises(InputError, match="did you mean funkhouser"):
        parse_policy("predictive:policy=funkhauser").make()
    with pytest.raises(InputError, match="got x; remove it"):
        parse_policy("predictive:policy=full+x=1").make()
    with pytest.raises(InputError, match="sees no future"):
        parse_policy("predictive:policy=oracle").make()


def test_capabilities_are_those_of_the_inner_policy() -> None:
    """They follow the policy, survive pickling, and do not change the class."""
    policy = Predictive("static-distance")
    assert not policy.capabilities.hierarchy
    assert Predictive("funkhouser").capabilities.hierarchy
    assert Predictive.capabilities.hierarchy
    assert pickle.loads(pickle.dumps(policy)).capabilities == policy.capabilities


class Recorder:
    """Keeps what a policy selects."""

    capabilities: ClassVar[Capabilities] = Capabilities()

    def __init__(self, policy: Policy) -> None:
        self.policy = policy
        self.selected: list[Selection] = []

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Reset the policy."""
        self.policy.reset(scene, budget_ms)

    def select(self, view: View) -> Selection:
        """Select and keep."""
        self.selected.append(self.policy.select(view))
        return self.selected[-1]


@pytest.mark.parametrize("eyes", [None, Eyes(apart_m=0.0)])
def test_speeds_are_those_of_the_predicted_pose(
    line: Scene,
    make_hardware: Make,
    make_trace: Make,
    monkeypatch: pytest.MonkeyPatch,
    eyes: Eyes | None,
) -> None:
    """Who turns by 9 degrees a second sees objects pass at that speed, whatever the horizon."""
    half = np.radians(4.5)
    turned = [(0.0, 0.0, 0.0, 1.0), (0.0, float(np.sin(half)), 0.0, float(np.cos(half)))]
    trace = replace(make_trace([(0.0, 0.0, 0.0)] * 2), orientation_xyzw=np.array(turned))
    speeds, select = list[float](), Full.select

    def watched(policy: Full, view: View) -> Selection:
        speeds.extend(view.speed_deg_s.tolist())
        return select(policy, view)

    monkeypatch.setattr(Full, "select", watched)
    policy = Predictive("full", horizon_ms=200.0)
    hardware = make_hardware(base_ms=20.0, frames_in_flight=1)
    options = ReplayOptions(budget_ms=10.0, fovy_deg=90.0, eyes=eyes)
    replay(policy, line, trace, hardware, options, name="predictive")
    assert np.median(speeds) == pytest.approx(9.0, rel=0.01)


def selection_lag(
    trace: CameraTrace, log: FrameLog, selected: list[Selection], scene: Scene
) -> float:
    """Return the mean difference, in levels, from what the pose at display would have selected."""
    plain = StaticDistance(near_m=0.0, far_m=64.0)
    plain.reset(scene, 10.0)
    gaps: list[float] = []
    for frame, selection in enumerate(selected):
        pose = trace.pose_at(log["display_ns"][frame] * 1e-9)
        away_m = np.linalg.norm(scene.center_m[selection.ids] - pose.position_m, axis=1)
        gaps += np.abs(selection.detail - np.minimum(np.floor(away_m), 63.0)).tolist()
    return float(np.mean(gaps))


@pytest.mark.parametrize(("kind", "at_most"), [("dash", 0.35), ("drive", 0.35), ("teleport", 1.0)])
def test_what_prediction_buys(
    make_scene: Make, make_levels: Make, make_hardware: Make, kind: str, at_most: float
) -> None:
    """At 10 Hz with 3 frames in flight, levels lag several times less; cuts make it no worse."""
    plan = np.random.default_rng(0).uniform(-60.0, 60.0, (400, 2))
    levels = make_levels([np.arange(64, 0, -1)])
    scene = make_scene(np.column_stack((plan, np.ones(400))), levels=levels)
    trace = generate(kind, duration_s=20.0, extent_m=100.0, seed=1)
    hardware = make_hardware({}, base_ms=100.0, frames_in_flight=3)
    lag: list[float] = []
    for policy in (StaticDistance(near_m=0.0, far_m=64.0), Predictive(DISTANCE)):
        recorder = Recorder(policy)
        options = ReplayOptions(budget_ms=50.0)
        log = replay(recorder, scene, trace, hardware, options, name="recorded")
        lag.append(selection_lag(trace, log, recorder.selected, scene))
    print(f"{kind}: {lag[0]:.3f} levels without, {lag[1]:.3f} with prediction")
    assert lag[1] <= at_most * lag[0]


@pytest.mark.parametrize(
    "params", [{"horizon_ms": -1.0}, {"max_speed_m_s": 0.0}, {"max_turn_deg_s": 0.0}]
)
def test_senseless_parameters_are_refused(line: Scene, params: dict[str, Any]) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"predictive: expected .*{next(iter(params))}.*, got"):
        Predictive(DISTANCE, **params).reset(line, 10.0)
