"""Frames drawn several deep: a replay on the wall clock, with a fence behind each frame.

Frame k + 1 is prepared while the device draws frame k; before frame k begins, the fence of frame
k - F is waited for, and then its input is sampled.  So this is the simulator's pipeline with
measured times in place of priced ones, and with its rule that a frame is in flight until its fence.

Nothing stops the clock: what Python takes to cull, to decide and to keep accounts is the CPU's part
of a frame here.  Fences are looked at before and after each of these, and waited for only where the
pipeline has to.  A device that is faster than the CPU is done with a frame some milliseconds before
anyone looks: when it was, its own timestamp says.
"""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...models.machine.hardware import Display, HardwareProfile
from ...models.scene.scene import Scene
from ...policies.protocol import Policy
from ...policies.shared.observer import watch
from ...sim.frame_log import COUNTS, TIMES, FrameLog
from ...sim.machine.simulated_machine import FrameTimes, Machine, Submitted
from ...sim.pipeline.pipeline import FrameSource, Pipeline
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from .draw_list import Frame
from .measures.fences import Fences
from .measures.timestamps import Timestamps
from .opengl_machine import COUNTED, expected_units, no_collection, picture_of
from .recorder import Recording, check_policy, logged_columns
from .renderer import Renderer

if TYPE_CHECKING:
    import moderngl

_WARMUP = 5
_DOUBT = "frames overlap"
_SAMPLES = COUNTED.index("shaded_samples")  # which are known after all that is counted


@dataclass(frozen=True, slots=True)
class _Flying:
    """A frame in flight: its fence, timestamp and query of samples, and when it was prepared."""

    fence: int
    mark: int
    query: "moderngl.Query"
    prepared_ns: int


class FlightMachine:
    """Submits each frame with a fence behind it, and waits for none.

    Attributes
    ----------
    submitted_ns : of its clock, when the last frame was handed over
    doubt : why there are no GPU times
    """

    def __init__(
        self,
        renderer: Renderer,
        fences: Fences,
        timestamps: Timestamps,
        clock: Callable[[], int] = time.perf_counter_ns,
    ) -> None:
        self._renderer, self._fences, self._timestamps = renderer, fences, timestamps
        self._clock = clock
        self._origin_ns = clock()
        self.submitted_ns = 0
        self._flying: deque[_Flying] = deque()
        self._queries: list[moderngl.Query] = []  # that no frame in flight needs
        self._landed_ns: list[int] = []
        self._rows: list[tuple[float, ...]] = []
        self._samples: list[float] = []
        self.doubt: str | None = _DOUBT

    def start(self) -> None:
        """Begin the replay's clock."""
        self._origin_ns = self._clock()

    def now_ns(self) -> int:
        """Return nanoseconds since the replay began, without what drivers compile at first."""
        return self._clock() - self._origin_ns

    def landed(self, frames: int = 0) -> list[int]:
        """Return when each frame so far was complete; wait until so many are."""
        while self._flying:
            frame = self._flying[0]
            if not self._fences.reached(frame.fence, wait=len(self._landed_ns) < frames):
                break
            seen_ns = self.now_ns()
            reached_ns = self._timestamps.reached_ns(frame.mark) - self._origin_ns
            # A device without a clock says 0, long before the frame was handed over.
            known = reached_ns >= frame.prepared_ns
            self._landed_ns.append(min(reached_ns, seen_ns) if known else seen_ns)
            self._flying.popleft()
            self._samples.append(float(frame.query.samples))
            self._queries.append(frame.query)
        return self._landed_ns

    def begin(self) -> None:
        """Look at fences before the policy decides."""
        self.landed()

    def run(self, frame: Submitted) -> FrameTimes:
        """Submit the frame; the pipeline learns later what it takes."""
        self.landed()
        picture = picture_of(frame)
        ready = self._renderer.prepare(picture)
        if not self._rows:
            self._warm_up(ready)
        query = self._queries.pop() if self._queries else self._renderer.context.query(samples=True)
        self.landed()
        prepared_ns = self.now_ns()
        with query:
            self._renderer.submit(ready, self._renderer.framebuffer(ready.size_px))
        mark = self._timestamps.mark()
        self._flying.append(_Flying(self._fences.set(), mark, query, prepared_ns))
        self.submitted_ns = self.now_ns()
        self.landed()
        counts = astuple(self._renderer.count(ready))
        units = expected_units(frame, picture)
        self._rows.append((*counts, *units, prepared_ns, self.submitted_ns))
        return FrameTimes(0.0, 0.0, 0.0)

    def _warm_up(self, frame: Frame) -> None:
        """Draw the first frame before it counts, with the clock at rest: nothing is in flight."""
        before_ns = self._clock()
        self._renderer.load_all()
        for _ in range(_WARMUP):
            self._renderer.draw(frame)
        self._timestamps.synchronise()
        self._origin_ns += self._clock() - before_ns

    def rows(self, times_ns: NDArray[np.int64]) -> dict[str, FloatArray]:
        """Return what was counted and measured, by name, one value a frame.

        ``cpu_ms`` is the submission alone, and ``prepare_ms`` all that went before it since the
        input was sampled; ``frame_ms`` is the time since the frame before was complete, as a frame
        rate has it, and ``lag_ms`` that since the frame's own input.

        Parameters
        ----------
        times_ns : (n, len(TIMES)) of the frames
        """
        table = np.array(self._rows, dtype=np.float64).reshape(-1, len(COUNTED) + 1)
        units = len(COUNTED) - 1
        held: FloatArray = np.insert(table[:, :units], _SAMPLES, self._samples, axis=1)
        prepared_ns, submitted_ns = table[:, units:].T
        times = dict(zip(TIMES, times_ns.T.astype(np.float64), strict=True))
        input_ns, end_ns = times["input_ns"], times["gpu_end_ns"]
        measured_ns: dict[str, FloatArray] = {
            "prepare_ms": prepared_ns - input_ns,
            "cpu_ms": submitted_ns - prepared_ns,
            "frame_ms": np.diff(end_ns, prepend=input_ns[:1]),
            "lag_ms": end_ns - input_ns,
        }
        counted: dict[str, FloatArray] = dict(zip(COUNTED, held.T, strict=True))
        return counted | {name: 1e-6 * value for name, value in measured_ns.items()}


class MeasuredPipeline(Pipeline):
    """The simulator's pipeline, its times those of a machine that draws."""

    def __init__(
        self, source: FrameSource, display: Display, frames_in_flight: int, machine: FlightMachine
    ) -> None:
        super().__init__(source, display, frames_in_flight)
        self._depth, self._frames, self._machine = frames_in_flight, source, machine

    def run(self) -> None:
        """Draw every frame until the source ends the replay, and wait for the last."""
        machine = self._machine
        machine.start()
        while True:
            frame = len(self.input_ns)
            self._learn(machine.landed(frame - self._depth + 1))
            time_ns = machine.now_ns()
            if self._frames.begin(frame, time_ns) is None:
                break
            self.input_ns.append(time_ns)
            self.cpu_end_ns.append(machine.submitted_ns)
            for later in (self.gpu_start_ns, self.gpu_end_ns, self.display_ns):
                later.append(-1)
        self._learn(machine.landed(len(self.input_ns)))

    def _learn(self, landed_ns: list[int]) -> None:
        """Note what is complete; each frame goes to the device when the one before leaves it."""
        for frame in range(self.completed, len(landed_ns)):
            free_ns = self.gpu_end_ns[frame - 1] if frame else 0
            self.gpu_start_ns[frame] = max(self.cpu_end_ns[frame], free_ns)
            # It may be done while the last of a submission is handed over.
            end_ns = max(landed_ns[frame], self.gpu_start_ns[frame])
            self.gpu_end_ns[frame] = self.display_ns[frame] = end_ns
        self.completed = len(landed_ns)


def record_in_flight(
    policy: Policy,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    machine: FlightMachine,
    *,
    name: str,
    watching: Machine | None = None,
) -> Recording:
    """Replay `trace` under `policy` with `hardware.frames_in_flight` frames in flight.

    Raises
    ------
    InputError, PolicyError
        As `recorder.record`.

    Parameters
    ----------
    watching : a machine that hands each frame on to `machine`
    """
    check_policy(policy, scene, name)
    watched = watch(policy)

    def pipeline(source: FrameSource, display: Display, frames_in_flight: int) -> Pipeline:
        return MeasuredPipeline(source, display, frames_in_flight, machine)

    with no_collection():
        log = replay(
            watched,
            scene,
            trace,
            hardware,
            options,
            name=name,
            machine=watching or machine,
            make_pipeline=pipeline,
        )
    log = _with_times(log)
    columns = logged_columns(log) | machine.rows(log.times_ns)
    columns["policy_ms"] = np.array(watched.select_ms)
    return Recording(log, columns, machine.doubt)


def _with_times(log: FrameLog) -> FrameLog:
    """Return a frame log whose CPU and GPU times are those of its pipeline."""
    counts = log.counts.copy()
    for name, start, end in (
        ("cpu_ms", "input_ns", "cpu_end_ns"),
        ("gpu_ms", "gpu_start_ns", "gpu_end_ns"),
    ):
        start_ns, end_ns = (log.times_ns[:, TIMES.index(time)] for time in (start, end))
        counts[:, COUNTS.index(name)] = 1e-6 * (end_ns - start_ns)
    return replace(log, counts=counts)
