"""Fixtures of the simulator: runs of the pipeline with scripted costs."""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.models.machine.hardware import Display, DisplayMode, HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities, Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import COUNTS, TIMES, FrameLog, LogHeader
from lodbench.sim.pipeline.pipeline import Pipeline
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace


class _Script:
    """A source of frames whose costs are given."""

    def __init__(self, cpu_ns: Sequence[int], gpu_ns: Sequence[int]) -> None:
        self.costs = list(zip(cpu_ns, gpu_ns, strict=True))

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Return the costs of a frame, None after the last."""
        return self.costs[frame] if frame < len(self.costs) else None


@pytest.fixture
def run_pipeline() -> Callable[..., FrameLog]:
    """Return a function that runs frames of skewed random costs, a few of them long."""
    return _run_pipeline


def _run_pipeline(mode: DisplayMode, frames: int = 400) -> FrameLog:
    rng = np.random.default_rng(1)
    cpu_ns = rng.lognormal(np.log(4e6), 0.3, frames).astype(np.int64)
    gpu_ns = rng.lognormal(np.log(9e6), 0.4, frames).astype(np.int64)
    gpu_ns[rng.random(frames) < 0.02] *= 6
    display = Display(mode=mode, refresh_hz=90.0, vrr_min_hz=40.0, latency_limit=0)
    pipeline = Pipeline(_Script(cpu_ns.tolist(), gpu_ns.tolist()), display, 2)
    pipeline.run()
    times = np.stack([np.array(getattr(pipeline, name)) for name in TIMES], axis=1)
    counts = np.zeros((frames, len(COUNTS)))
    columns = {
        "cpu_ms": cpu_ns / 1e6,
        "gpu_ms": gpu_ns / 1e6,
        "select_ms": np.full(frames, 0.25),
        "triangles": rng.integers(1_000, 9_000, frames),
        "draw_calls": rng.integers(10, 90, frames),
        "toggles": rng.integers(0, 5, frames),
    }
    for name, values in columns.items():
        counts[:, COUNTS.index(name)] = values
    policy = "feedback:gain=0.5,delay=2"
    header = LogHeader(policy, "scene", "trace", "machine", 10.0, 3, mode, 90.0, 1e9)
    return FrameLog(header, times.astype(np.int64), counts)


@pytest.fixture(scope="session")
def run_frames() -> Callable[..., Pipeline]:
    """Return a function that runs frames of given CPU and GPU nanoseconds to the end."""
    return _run_frames


def _run_frames(
    cpu_ns: Sequence[int], gpu_ns: Sequence[int], frames_in_flight: int = 2, **display: Any
) -> Pipeline:
    # At once and unpaced, unless a test is about that: nothing then delays what it works out.
    given: dict[str, Any] = {"mode": "immediate", "latency_limit": 0} | display
    screen = Display(**given)
    pipeline = Pipeline(_Script(cpu_ns, gpu_ns), screen, frames_in_flight)
    pipeline.run()
    return pipeline


class _Scripted:
    """Draws given details, one row a frame (the last for ever) and one value a candidate."""

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    def __init__(
        self,
        details: Sequence[Any],
        change: Callable[[View, Selection], Selection] | None = None,
        **selection: Any,
    ) -> None:
        self.details, self.change, self.selection = details, change, selection

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare nothing."""

    def select(self, view: View) -> Selection:
        """Return the row of the frame, changed at the end if asked for."""
        row = self.details[min(view.frame, len(self.details) - 1)]
        detail = np.broadcast_to(np.asarray(row, dtype=np.float64), (len(view),))
        selection = Selection(view.ids, detail, **self.selection)
        return self.change(view, selection) if self.change else selection


@pytest.fixture(scope="session")
def scripted() -> Callable[..., Policy]:
    """Return a policy class that draws given details and changes selections as told."""
    return _Scripted


@pytest.fixture(scope="session")
def run(
    make_scene: Callable[..., Scene],
    make_hardware: Callable[..., HardwareProfile],
    make_trace: Callable[..., CameraTrace],
) -> Callable[..., FrameLog]:
    """Return a function that replays a policy on objects 10 m ahead of a camera that stands."""

    def replayed(
        policy: Policy,
        frames: int = 1,
        *,
        positions: Any = ((0.0, 0.0, -10.0),),
        hardware: HardwareProfile | None = None,
        scene: Scene | None = None,
        options: dict[str, Any] | None = None,
        **more: Any,
    ) -> FrameLog:
        given: dict[str, Any] = {"budget_ms": 10.0, "fovy_deg": 90.0, **(options or {})}
        return replay(
            policy,
            scene or make_scene(positions, **more),
            make_trace(),
            hardware or make_hardware(),
            ReplayOptions(frames=frames, **given),
            name="scripted",
        )

    return replayed
