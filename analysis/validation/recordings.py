"""Record replays on a real renderer: what `lodbench record` and `lodbench validate` share."""

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import OpenedScene
from ...policies.registry import parse_policy
from ...render.gl.context import Device, Target, open_target
from ...render.gl.frames_in_flight import FlightMachine, record_in_flight
from ...render.gl.image_comparison import PictureDifference, PictureFolder, PictureMachine
from ...render.gl.measures.fences import Fences
from ...render.gl.measures.reference_draw import ReferenceDraw
from ...render.gl.measures.timestamps import Timestamps
from ...render.gl.opengl_machine import GlMachine
from ...render.gl.recorder import Recording, check_policy, header_of, record
from ...render.gl.renderer import Renderer
from ...render.gl.shuffled_programme import record_programme
from ...render.gl.vertex_order import vertex_order
from ...sim.frame_log import FrameLog
from ...sim.machine.simulated_machine import FrameTimes, Machine, Submitted
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.runs import Progress
from .record_options import CLOCKS, RecordOptions

CALIBRATION = "calibration"
"""Name of the programme in place of a policy's."""

_OCCASION = uuid4().hex[:12]  # what one process records shares more than the machine


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """A render log with what it is of, the frame log, and comparisons of pictures, if asked for."""

    header: dict[str, str]
    columns: dict[str, NDArray[np.float64]]
    frames: FrameLog
    pictures: tuple[PictureDifference, ...] = ()


class Recorder:
    """A scene on a device, ready to record one policy after another.

    Raises `InputError` if the device cannot be timed as asked, or the scene has no meshes.
    """

    def __init__(self, target: Target, scene: OpenedScene, settings: RecordOptions) -> None:
        settings.require_device(target.device)
        self._device: Device = target.device
        self._scene, self._settings = scene.scene, settings
        clock = CLOCKS[settings.clock]
        self._renderer = Renderer(
            target,
            scene.scene,
            scene.read_geometry(),
            instancing=settings.instancing,
            clock=clock,
        )
        self._fences = Fences(target.load)
        self._timestamps = Timestamps(target.load, CLOCKS["wall"])
        self._reference = ReferenceDraw(target, clock)

    def record(
        self,
        label: str | None,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        *,
        pictures: PictureFolder | None = None,
        progress: Progress | None = None,
        on_pass: Callable[[Recorded], None] | None = None,
    ) -> Recorded:
        """Record a policy, or the programme of calibration where there is none.

        Calibration goes through the whole trace in even steps, drawn twice in shuffled order, and
        `on_pass` has what there is after the first time; a policy's replay takes as many frames as
        last until its end.

        Raises
        ------
        InputError, PolicyError
            As `render.gl.recorder.record`.
        """
        compared: Sequence[PictureDifference] = ()

        def told(recording: Recording) -> Recorded:
            about = conditions(self._scene, trace, hardware, options) | self._about(label, options)
            header = header_of(self._device, about, recording.doubt)
            return Recorded(header, recording.columns, recording.frames, tuple(compared))

        if self._settings.frames_in_flight:
            recording = self._in_flight(label, trace, hardware, options, pictures, progress)
        elif label is None:
            if pictures is not None:
                raise InputError("--images: expected --policy, got --calibrate, which is no replay")

            def passed(recording: Recording) -> None:
                if on_pass is not None:
                    on_pass(told(recording))

            recording = self._programme(trace, hardware, options, progress, passed)
        else:
            recording, compared = self._policy(label, trace, hardware, options, pictures, progress)
        return told(recording)

    def _about(self, label: str | None, options: ReplayOptions) -> dict[str, str]:
        settings = self._settings
        about = {
            "policy": label or CALIBRATION,
            "seed": str(options.seed),
            "draws": "instanced" if settings.instancing else "each object",
            "repeats": "1" if settings.frames_in_flight else str(settings.repeats),
            "clock": settings.clock,
            "occasion": _OCCASION,
            "order": "shuffled" if label is None else "path",
            "frames_in_flight": str(max(settings.frames_in_flight, 1)),
            "vertex_order": vertex_order(),
        }
        return about | ({"threads": str(settings.threads)} if self._device.software else {})

    def _measuring(self) -> GlMachine:
        repeats = self._settings.repeats
        return GlMachine(self._renderer, self._device, repeats=repeats, reference=self._reference)

    def _policy(
        self,
        label: str,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        pictures: PictureFolder | None,
        progress: Progress | None,
    ) -> tuple[Recording, Sequence[PictureDifference]]:
        measuring = self._measuring()
        machine: Machine = measuring
        watching = None
        if pictures is not None:
            watching = machine = PictureMachine(measuring, self._renderer, pictures)
        if progress is not None:
            machine = _Told(machine, progress, options.frames, trace.duration_s)
        policy = parse_policy(label).make()
        recording = record(
            policy, self._scene, trace, hardware, options, machine, measuring, name=label
        )
        return recording, () if watching is None else watching.compared

    def _in_flight(
        self,
        label: str | None,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        pictures: PictureFolder | None,
        progress: Progress | None,
    ) -> Recording:
        if label is None or pictures is not None:
            other = "--calibrate" if label is None else "--images"
            raise InputError(
                f"--frames-in-flight: expected a policy whose frames nothing waits for, got {other}"
            )
        machine = FlightMachine(self._renderer, self._fences, self._timestamps)
        told = None
        if progress is not None:
            told = _Told(machine, progress, options.frames, trace.duration_s)
        flying = replace(hardware, frames_in_flight=self._settings.frames_in_flight)
        return record_in_flight(
            parse_policy(label).make(),
            self._scene,
            trace,
            flying,
            options,
            machine,
            name=label,
            watching=told,
        )

    def _programme(
        self,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        progress: Progress | None,
        on_pass: Callable[[Recording], None],
    ) -> Recording:
        _require_flat(self._scene)
        return record_programme(
            self._scene,
            trace,
            hardware,
            replace(options, frames=self._settings.calibration_steps),
            self._measuring(),
            name=CALIBRATION,
            progress=progress,
            on_pass=on_pass,
        )


@contextmanager
def open_recorder(
    scene: OpenedScene, settings: RecordOptions, size_px: tuple[int, int]
) -> Generator[Recorder]:
    """Yield a recorder of a scene, and give its context back.

    Raises `InputError` if there is no context to be had, or the scene has no meshes.
    """
    target = open_target(settings.backend, size_px, threads=settings.threads)
    try:
        yield Recorder(target, scene, settings)
    finally:
        target.close()


def conditions(
    scene: Scene, trace: CameraTrace, hardware: HardwareProfile, options: ReplayOptions
) -> dict[str, str]:
    """Return what recordings have to share to be compared, as the headers of their logs say it."""
    start = ", ".join(f"{value:.6g}" for value in trace.pose_at(0.0).position_m)
    return {
        "resolution": f"{hardware.display.width_px}x{hardware.display.height_px}",
        "scene": scene.name,
        "trace": trace.name,
        "trace_s": f"{trace.duration_s:.6g}",
        "start_m": start,
        "budget_ms": f"{options.budget_ms:.6g}",
        "fovy_deg": f"{options.fovy_deg:.6g}",
    }


def require_recordable(labels: Sequence[str], scene: Scene) -> None:
    """Raise InputError if a policy cannot be recorded in a scene, before any is."""
    for label in labels:
        check_policy(parse_policy(label).make(), scene, label)


def _require_flat(scene: Scene) -> None:
    if not scene.flat:
        raise InputError(
            f"--calibrate: expected a flat scene, got {scene.name}, which is a hierarchy; "
            "calibrate on another, such as plaza: costs are those of the machine"
        )


class _Told:
    """A machine that tells how far a replay has come."""

    def __init__(
        self, machine: Machine, progress: Progress, frames: int | None, duration_s: float
    ) -> None:
        self._machine, self._progress = machine, progress
        self._frames, self._duration_s = frames, duration_s

    def begin(self) -> Any:
        """Begin a frame."""
        return self._machine.begin()

    def run(self, frame: Submitted) -> FrameTimes:
        """Run the frame, then tell."""
        times = self._machine.run(frame)
        if self._frames is not None:
            self._progress(frame.view.frame + 1, self._frames)
        else:
            self._progress(frame.view.time_ns // 1_000_000, int(1e3 * self._duration_s) + 1)
        return times
