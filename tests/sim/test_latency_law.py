"""The latency law: when a loop that steers detail by late measurements is stable.

A policy that keeps work near a target multiplies a threshold tau, ``tau <- tau · (measured /
target)^g``, and work falls with it as ``K · tau^(-p)``.  With ``e = log(work / target)`` and a
measurement that is k frames late, this is the linear recurrence ``e_(t+1) = e_t - g·p·e_(t-k)``.
Its characteristic polynomial ``z^(k+1) - z^k + g·p`` first has a root on the unit circle at
``g·p = 2 cos(k·pi / (2k + 1))``: 2, 1, 0.618, 0.445, 0.347 for k = 0 to 4.

Here nothing is told about k.  A real replay runs one continuous object whose GPU time is K times
its resolution, with a CPU of a nanosecond; k follows from the pipeline alone.  With F frames in
flight on a GPU-bound queue, frame t samples its input when frame t - F completes, and a timer that
is read d frames after completion has by then reported frame t - F - d: so k = F + d - 1.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

TARGET_MS = 10.0
FULL_MS = 100.0  # K, so that the target asks for a resolution of 0.1, amid the range
COARSEST = 0.01
ELASTICITY = 0.5  # p
FRAMES = 400
Replay = Callable[[float, int, int], np.ndarray]


class Steered:
    """Draws the object at ``tau^(-p)`` and steers tau by the newest report."""

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, continuous=True)

    def __init__(self, gain: float) -> None:
        self.gain = gain

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Start 1 % above the target."""
        self.target_ms = budget_ms
        self.tau = (1.01 * budget_ms / FULL_MS) ** (-1.0 / ELASTICITY)

    def select(self, view: View) -> Selection:
        """Multiply tau once for every frame's report."""
        measured_ms = view.completed.last_work_ms()
        if not math.isnan(measured_ms):
            self.tau *= (measured_ms / self.target_ms) ** self.gain
        resolution = min(max(self.tau**-ELASTICITY, COARSEST), 1.0)
        return Selection(view.ids, np.full(len(view.ids), resolution))


@pytest.fixture(scope="module")
def steer(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., object],
    make_hardware: Callable[..., HardwareProfile],
    make_trace: Callable[..., CameraTrace],
) -> Replay:
    """Return a function from g·p, frames in flight and delay to the error of each frame."""
    triangles = 1e6
    levels = make_levels([(triangles, COARSEST * triangles)], continuous=True)
    scene = make_scene([(0.0, 0.0, -10.0)], levels=levels)
    trace = make_trace()

    def run(loop_gain: float, frames_in_flight: int, delay: int) -> np.ndarray:
        hardware = make_hardware(
            {"triangles": FULL_MS / triangles},
            base_ms=0.0,
            cpu_base_ms=0.0,
            frames_in_flight=frames_in_flight,
        )
        options = ReplayOptions(budget_ms=TARGET_MS, frames=FRAMES, measurement_delay=delay)
        policy = Steered(loop_gain / ELASTICITY)
        log = replay(policy, scene, trace, hardware, options, name="steered")
        return np.log(log["gpu_ms"] / TARGET_MS)

    return run


def grows(error: np.ndarray) -> bool:
    """Return whether a run errs more in its last quarter than in its second, or hit the limits."""
    _, early, _, late = np.abs(error).reshape(4, -1).max(axis=1)
    return bool(late > early or late > 0.5)


@pytest.mark.parametrize(
    ("frames_in_flight", "delay"),
    [(1, 0), (2, 0), (1, 1), (3, 0), (1, 2), (4, 0), (2, 2), (4, 1), (1, 4)],
)
def test_critical_gain_follows_from_the_delay_alone(
    steer: Replay, frames_in_flight: int, delay: int
) -> None:
    """Errors die out 1 % below 2 cos(k pi / (2k + 1)) and grow 1 % above; k = F + d - 1, 0 to 4."""
    k = frames_in_flight + delay - 1
    law = 2.0 * math.cos(k * math.pi / (2 * k + 1))
    assert not grows(steer(0.99 * law, frames_in_flight, delay))
    assert grows(steer(1.01 * law, frames_in_flight, delay))


def test_a_loop_without_delay_settles_in_one_step(steer: Replay) -> None:
    """With one frame in flight, no delay and g·p = 1, the second frame is on target."""
    error = steer(1.0, 1, 0)
    assert error[0] == pytest.approx(math.log(1.01), abs=1e-6)
    assert np.abs(error[1:]).max() < 1e-6


@pytest.mark.parametrize(("frames_in_flight", "delay"), [(1, 0), (2, 0), (3, 0), (4, 1)])
def test_errors_follow_the_recurrence_frame_by_frame(
    steer: Replay, frames_in_flight: int, delay: int
) -> None:
    """Each frame's error is ``e_t - g·p·e_(t-k)``, to the rounding of a nanosecond."""
    k, loop_gain = frames_in_flight + delay - 1, 0.3
    error = steer(loop_gain, frames_in_flight, delay)
    expected = list(error[: 2 * k + 2])
    for t in range(2 * k + 1, len(error) - 1):
        expected.append(expected[t] - loop_gain * expected[t - k])
    assert error == pytest.approx(np.array(expected), abs=1e-5)
