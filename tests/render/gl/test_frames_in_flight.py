"""Frames in flight: on a device by script against the pipeline by hand, and on a real one."""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count, pairwise
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Capabilities, Policy
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.render.gl.draw_list import Counts
from lodbench.render.gl.frames_in_flight import FlightMachine, record_in_flight
from lodbench.render.gl.measures.fences import Fences
from lodbench.render.gl.measures.timestamps import Timestamps
from lodbench.render.gl.recorder import Recording, recorded_hardware
from lodbench.render.gl.renderer import Renderer
from lodbench.sim.frame_log import TIMES
from lodbench.sim.replay import ReplayOptions

MS = 1_000_000
FRAMES = 30


class World:
    """A clock, a renderer whose work moves it, and a device that works beside it.

    To prepare a frame takes 0.4 of `cpu_ms`, to submit it 0.6; the device takes `gpu_ms` a frame,
    one after another.  What comes before the first frame takes two seconds.
    """

    def __init__(self, cpu_ms: float, gpu_ms: float, *, stamps: bool = True) -> None:
        self.now_ns, self.stamps = 5 * MS, stamps
        self.prepare_ns, self.submit_ns = round(0.4 * cpu_ms * MS), round(0.6 * cpu_ms * MS)
        self.gpu_ns, self.done_ns = round(gpu_ms * MS), list[int]()
        self.context, self.samples = self, 0
        self._numbers = count()

    def clock(self) -> int:
        """Return the time."""
        return self.now_ns

    def prepare(self, picture: Any) -> Any:
        """Take the time to prepare."""
        self.now_ns += self.prepare_ns
        return picture

    def load_all(self) -> None:
        """Take two seconds."""
        self.now_ns += 2_000 * MS

    def draw(self, frame: Any) -> None:
        """Draw at once: to warm up."""

    def count(self, frame: Any) -> Counts:
        """Return some counts."""
        return Counts(1, 2, 3, 4, 5, 6, 7, 8, 0)

    def framebuffer(self, size_px: Any) -> None:
        """Have none."""

    def query(self, **_: Any) -> Any:
        """Return a query that is its own context, and counts as many samples as queries made."""
        return _Query(next(self._numbers))

    def submit(self, frame: Any, picture: Any) -> None:
        """Take the time to submit."""
        self.now_ns += self.submit_ns

    def set(self) -> int:
        """Set a fence behind the frame; the device takes it when it is free."""
        free_ns = max(self.now_ns, self.done_ns[-1] if self.done_ns else 0)
        self.done_ns.append(free_ns + self.gpu_ns)
        return len(self.done_ns) - 1

    def synchronise(self) -> None:
        """Have one clock."""

    def mark(self) -> int:
        """Mark the end of a frame, whose fence is set next."""
        return len(self.done_ns)

    def reached_ns(self, mark: int) -> int:
        """Say when a frame was done; without a clock of its own the device says 0."""
        return self.done_ns[mark] if self.stamps else 0

    def reached(self, fence: int, *, wait: bool) -> bool:
        """Wait for a fence, or look."""
        if wait:
            self.now_ns = max(self.now_ns, self.done_ns[fence])
        return self.now_ns >= self.done_ns[fence]


class _Query:
    def __init__(self, samples: int) -> None:
        self.samples = samples

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, *_: object) -> None:
        """End."""


class Listener:
    """Draws everything, and notes how many times it knows."""

    capabilities: ClassVar[Capabilities] = Capabilities()

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget what was heard."""
        self.heard, self.work_ms = list[int](), list[float]()

    def select(self, view: View) -> Selection:
        """Note what is complete."""
        self.heard.append(len(view.completed))
        self.work_ms.append(view.completed.last_work_ms())
        return Selection(view.ids, np.zeros(len(view)))


@pytest.fixture
def fly(
    make_scene: Callable[..., Scene],
    make_trace: Callable[..., Any],
    make_hardware: Callable[..., HardwareProfile],
) -> Callable[..., Recording]:
    """Return a function that records a policy in a world by script."""

    def recorded(world: Any, depth: int, policy: Policy | None = None) -> Recording:
        machine = FlightMachine(world, world, world, world.clock)
        hardware = replace(recorded_hardware(make_hardware(), (100, 60)), frames_in_flight=depth)
        options = ReplayOptions(budget_ms=10.0, frames=FRAMES)
        scene = make_scene([(0.0, 0.0, -10.0)])
        return record_in_flight(
            policy or Full(), scene, make_trace(), hardware, options, machine, name="a policy"
        )

    return recorded


@pytest.mark.parametrize("depth", [1, 2, 3, 4])
def test_lag_of_a_busy_device_grows_with_depth(fly: Any, depth: int) -> None:
    """A device of 10 ms behind a CPU of 1 ms: F frames wait 10 F ms; one alone takes its 11 ms."""
    columns = fly(World(1.0, 10.0), depth).columns
    lag_ms, frame_ms = (11.0, 11.0) if depth == 1 else (10.0 * depth, 10.0)
    assert columns["lag_ms"][depth:] == pytest.approx(lag_ms)
    assert columns["frame_ms"][depth:] == pytest.approx(frame_ms)
    assert np.diff(columns["trace_s"])[depth:] == pytest.approx(1e-3 * frame_ms)


@pytest.mark.parametrize("depth", [2, 3, 4])
def test_lag_of_a_busy_cpu_does_not(fly: Any, depth: int) -> None:
    """A CPU of 10 ms before a device of 5: complete after 15, by the device's own clock.

    Without one a frame is complete when the next one looks, which prepares for 4 ms and submits for
    6, and looks before and after the submission.
    """
    columns = fly(World(10.0, 5.0), depth).columns
    assert columns["frame_ms"][1:-1] == pytest.approx(10.0)
    assert columns["lag_ms"] == pytest.approx(15.0)
    columns = fly(World(10.0, 5.0, stamps=False), depth).columns
    assert columns["frame_ms"][1:-1] == pytest.approx(10.0)
    assert columns["lag_ms"][:-1] == pytest.approx(20.0)  # at the end of the submission
    assert columns["lag_ms"][-1] == pytest.approx(15.0)  # the last one is waited for


def test_times_of_the_cpu_are_apart(fly: Any) -> None:
    """Two fifths to prepare, three to submit; what came before the first frame is in neither."""
    found = fly(World(2.0, 10.0), 2)
    assert found.columns["prepare_ms"] == pytest.approx(0.8)
    assert found.columns["cpu_ms"] == pytest.approx(1.2)
    assert found.frames["cpu_ms"] == pytest.approx(2.0)
    assert found.frames["gpu_ms"] == pytest.approx(10.0)
    assert found.frames["input_ns"][0] == 0
    assert "gpu_ms" not in found.columns
    assert found.doubt == "frames overlap"


@pytest.mark.parametrize("depth", [1, 3])
def test_a_policy_hears_of_frames_whose_fence_was_waited_for(fly: Any, depth: int) -> None:
    """Before frame k it knows the times of all frames up to k - F."""
    listener = Listener()
    fly(World(1.0, 10.0), depth, listener)
    assert listener.heard == [max(0, frame - depth + 1) for frame in range(FRAMES)]
    assert np.array(listener.work_ms[depth:]) == pytest.approx(10.0)


def test_samples_are_those_of_the_frame(fly: Any) -> None:
    """Queries are used again when their frame is complete: no more are made than fly at once."""
    samples = fly(World(1.0, 10.0), 2).columns["shaded_samples"]
    assert samples.tolist() == [0.0, 1.0] * (FRAMES // 2)


def test_a_policy_that_cannot_be_recorded(fly: Any) -> None:
    """It is refused in one line before anything is drawn."""
    world = World(1.0, 10.0)
    with pytest.raises(InputError, match="a policy: expected a policy that can be recorded"):
        fly(world, 2, parse_policy("oracle").make())
    assert world.done_ns == []


@pytest.mark.parametrize("depth", [1, 2, 4])
def test_the_pipeline_of_a_real_device(
    target: Any, plaza: Any, tour: Any, llvmpipe: Any, depth: int
) -> None:
    """Whatever it takes: no more than F frames fly, and times are in order."""
    scene, geometry = plaza
    renderer = Renderer(target, scene, geometry, instancing=True)
    stamps = Timestamps(target.load, time.perf_counter_ns)
    machine = FlightMachine(renderer, Fences(target.load), stamps)
    hardware = replace(recorded_hardware(llvmpipe, (64, 36)), frames_in_flight=depth)
    options = ReplayOptions(budget_ms=4.0, frames=12)
    policy = parse_policy("feedback").make()
    found = record_in_flight(policy, scene, tour, hardware, options, machine, name="feedback")
    times = dict(zip(TIMES, found.frames.times_ns.T, strict=True))
    for earlier, later in pairwise(TIMES):
        assert (times[earlier] <= times[later]).all()
    assert (times["gpu_end_ns"][:-depth] <= times["input_ns"][depth:]).all()
    assert (np.diff(times["gpu_end_ns"]) >= 0).all()
    lag_ms = 1e-6 * (times["gpu_end_ns"] - times["input_ns"])
    assert found.columns["lag_ms"] == pytest.approx(lag_ms)
    assert found.columns["trace_s"] == pytest.approx(1e-9 * times["input_ns"])
    assert found.columns["triangles"].tolist() == found.frames["triangles"].tolist()
    assert (found.columns["shaded_samples"] > 0.0).all()
