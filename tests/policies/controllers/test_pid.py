"""Test the controller of an angle of detail."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.controllers.pid import Pid
from lodbench.policies.frame_times import Completed
from lodbench.policies.view import View

Make = Callable[..., Any]
BUDGET_MS = 20.0  # 50 Hz, so the target is 55 Hz
STEP_S = 0.016


@pytest.fixture(scope="module")
def rows(make_scene: Make, make_levels: Make) -> Scene:
    """Return an object of 5.7 degrees (radius 1 m at 20 m) with 30 levels at ratio 0.95."""
    levels = make_levels([np.arange(300, 0, -1)])
    return make_scene([(0.0, 0.0, -20.0)], levels=levels)


class Driven:
    """A controller fed with one time a frame, at a fixed interval."""

    def __init__(self, scene: Scene, make_view: Make, **params: Any) -> None:
        self.policy = Pid(**params)
        self.policy.reset(scene, BUDGET_MS)
        self.base = make_view(scene)
        self.times_ms = np.full((5000, 4), np.nan)
        self.frame = 0

    def step(self, time_ms: float) -> float:
        """Report one frame's time, and return the angle after it."""
        self.times_ms[self.frame] = time_ms
        self.frame += 1
        completed = Completed(self.times_ms, self.frame)
        time_ns = round(self.frame * STEP_S * 1e9)
        state = replace(self.base.state, frame=self.frame, time_ns=time_ns, completed=completed)
        self.policy.select(View(state, self.base.ids, self.base.xyz_m))
        return self.policy._angle_deg  # pyright: ignore[reportPrivateUsage] - levels are coarser


def test_first_error_moves_the_angle_by_itself(rows: Scene, make_view: Make) -> None:
    """25 ms is 40 Hz, 15 below the target of 55: with Kp = 1 the angle grows by 15 / 55 degrees."""
    driven = Driven(rows, make_view)
    assert driven.step(25.0) == pytest.approx(10.0 + 15.0 / 55.0)
    faster = Driven(rows, make_view)
    assert faster.step(10.0) == pytest.approx(10.0 - 45.0 / 55.0)


def test_running_means_and_the_noise_gate(rows: Scene, make_view: Make) -> None:
    """A second time by hand: means over 80 and 800 ms, the error weighted by the variance."""
    driven = Driven(rows, make_view)
    first = driven.step(25.0)
    now_ms = 25.0 + 0.2 * (40.0 - 25.0)  # 16 ms of 80
    smooth_ms = 25.0 + 0.02 * (40.0 - 25.0)  # 16 ms of 800
    error_hz = 55.0 - 1e3 / smooth_ms
    variance = (1e3 / smooth_ms - 1e3 / now_ms) ** 2
    weight = min(max(error_hz**2 / variance - 1.0, 0.0), 1.0)
    assert weight == 1.0
    assert driven.step(40.0) == pytest.approx(first + weight * error_hz / 55.0)


def test_errors_within_the_variance_are_noise(rows: Scene, make_view: Make) -> None:
    """Near the target a single spike of 60 ms moves nothing; without the gate it does."""
    moved: list[float] = []
    for kv in (1.0, 0.0):
        driven = Driven(rows, make_view, kv=kv)
        rested = driven.step(1e3 / 55.0)
        assert rested == pytest.approx(10.0)
        moved.append(driven.step(60.0) - rested)
    assert moved[0] == 0.0
    assert moved[1] > 0.01


def test_integral_and_slope(rows: Scene, make_view: Make) -> None:
    """With Kp = 0, Ki = 2 and Kd = 0.1 the first output is 2 · e · dt + 0.1 · e / dt."""
    driven = Driven(rows, make_view, kp=0.0, ki=2.0, kd=0.1)
    error = 15.0 / 55.0
    expected = 10.0 + 2.0 * error * STEP_S + 0.1 * error / STEP_S
    assert driven.step(25.0) == pytest.approx(expected)


def test_the_angle_stays_in_its_range(rows: Scene, make_view: Make) -> None:
    """Hopeless frames end at 90 degrees, idle ones at 0.001."""
    slow, fast = Driven(rows, make_view), Driven(rows, make_view)
    angles = [(slow.step(200.0 + i), fast.step(1.0 + 1e-3 * i)) for i in range(300)]
    assert angles[-1] == (90.0, 0.001)


def test_an_object_as_large_as_the_angle_has_its_finest_level(rows: Scene, make_view: Make) -> None:
    """Radius over distance is 1 / 20, so the angle is 2 atan(1 / 20); a hair more is level 1."""
    angle_deg = math.degrees(2.0 * math.atan(1.0 / 20.0))
    for start_deg, level in ((angle_deg * 0.999, 0), (angle_deg * 1.001, 1), (angle_deg * 2.01, 2)):
        policy = Pid(start_deg=start_deg)
        policy.reset(rows, BUDGET_MS)
        assert policy.select(make_view(rows)).detail.tolist() == [level]


def test_it_steers_a_load_to_its_target(rows: Scene, make_view: Make) -> None:
    """Work that falls with the angle as ``200 ms / degrees`` ends near 55 Hz."""
    driven = Driven(rows, make_view)
    angle_deg = 10.0
    for frame in range(2000):
        angle_deg = driven.step(200.0 / angle_deg * (1.0 + 1e-6 * (frame % 3)))
    assert 200.0 / angle_deg == pytest.approx(1e3 / 55.0, rel=0.02)


def test_faulty_times_never_raise_detail(rows: Scene, make_view: Make) -> None:
    """Missing, zero and negative reports leave the angle."""
    driven = Driven(rows, make_view)
    rested = driven.step(12.0)
    for fault in (np.nan, 0.0, -5.0):
        assert driven.step(fault) == rested
    assert driven.step(11.0) < rested


@pytest.mark.parametrize(
    "params",
    [
        {"kp": -1.0},
        {"kv": math.nan},
        {"tau_s": 0.0},
        {"smooth": 0.5},
        {"start_deg": 120.0},
        {"max_deg": 180.0},
    ],
)
def test_senseless_parameters_are_refused(rows: Scene, params: dict[str, float]) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"pid: expected .*{next(iter(params))}.*, got"):
        Pid(**params).reset(rows, 10.0)
