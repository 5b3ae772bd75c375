"""Record replays on a real renderer: what `lodbench record` and `lodbench validate` share."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import OpenedScene
from ...policies.registry import parse_policy
from ...render.gl.calibration import Calibration
from ...render.gl.context import Device, Target, open_target
from ...render.gl.image_comparison import (
    PictureDifference,
    PictureFolder,
    PictureMachine,
    summarise_pictures,
)
from ...render.gl.opengl_machine import GlMachine
from ...render.gl.recorder import check_policy, header_of, record
from ...render.gl.renderer import Renderer
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...sim.simulated_machine import FrameTimes, Machine, Submitted
from ...traces.cameras.camera_trace import CameraTrace
from ..study.runs import Progress

CALIBRATION = "calibration"
"""Name of the programme in place of a policy's."""

_MOST_THREADS = 32  # of llvmpipe


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordOptions:
    """How to draw.

    Attributes
    ----------
    backend : one of `context.BACKENDS`
    instancing : whether all instances of a level are drawn at once
    repeats : times that each frame is drawn
    threads : of llvmpipe, beside the caller's
    calibration_steps : poses along the trace that calibration draws
    """

    backend: str = "egl"
    instancing: bool = False
    repeats: int = 5
    threads: int = 0
    calibration_steps: int = 1_200

    def __post_init__(self) -> None:
        if not 0 <= self.threads <= _MOST_THREADS:
            got = self.threads
            raise InputError(f"--threads: expected 0 to {_MOST_THREADS}, got {got}; 0 is quietest")
        if self.calibration_steps < 1:
            raise InputError(f"--steps: expected 1 or more, got {self.calibration_steps}")


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """A render log with what it is of, the frame log, and comparisons of pictures, if asked for."""

    header: dict[str, str]
    columns: dict[str, NDArray[np.float64]]
    frames: FrameLog
    pictures: tuple[PictureDifference, ...] = ()


class Recorder:
    """A scene on a device, ready to record one policy after another."""

    def __init__(self, target: Target, scene: OpenedScene, settings: RecordOptions) -> None:
        self._device: Device = target.device
        self._scene, self._settings = scene.scene, settings
        self._renderer = Renderer(
            target, scene.scene, scene.read_geometry(), instancing=settings.instancing
        )

    def record(
        self,
        label: str | None,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        *,
        pictures: PictureFolder | None = None,
        progress: Progress | None = None,
    ) -> Recorded:
        """Record a policy, or the programme of calibration where there is none.

        Calibration goes through the whole trace in even steps; a policy's replay takes as many
        frames as last until its end.

        Raises
        ------
        InputError, PolicyError
            As `render.gl.recorder.record`.
        """
        settings, name, step_ms = self._settings, label or CALIBRATION, None
        policy = Calibration(options.seed) if label is None else parse_policy(label).make()
        if label is None:
            _require_flat(self._scene)
            options = replace(options, frames=settings.calibration_steps)
            step_ms = max(1e3 * trace.duration_s / settings.calibration_steps, 1e-3)
        measuring = GlMachine(
            self._renderer, self._device, repeats=settings.repeats, step_ms=step_ms
        )
        machine: Machine = measuring
        watching = None
        if pictures is not None:
            watching = machine = PictureMachine(measuring, self._renderer, pictures)
        if progress is not None:
            machine = _Told(machine, progress, options.frames, trace.duration_s)
        recording = record(
            policy, self._scene, trace, hardware, options, machine, measuring, name=name
        )
        about = conditions(self._scene, trace, hardware, options) | {
            "policy": name,
            "seed": str(options.seed),
            "draws": "instanced" if settings.instancing else "each object",
            "repeats": str(settings.repeats),
        }
        if self._device.software:
            about["threads"] = str(settings.threads)
        header = header_of(self._device, about, recording.doubt)
        compared = () if watching is None else tuple(watching.compared)
        return Recorded(header, recording.columns, recording.frames, compared)


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


def summary_of(recorded: Recorded) -> dict[str, Any]:
    """Return what was recorded in numbers; medians of the repeats, in milliseconds."""
    columns, frame_ms = recorded.columns, recorded.columns["frame_ms"]
    spread = (columns["frame_ms_high"] - columns["frame_ms_low"]) / frame_ms
    means = {
        name: float(columns[name].mean())
        for name in ("draw_calls", "triangles", "shaded_samples", "cpu_ms", "policy_ms")
    }
    record: dict[str, Any] = {
        "schema": "lodbench.record/1",
        "frames": len(frame_ms),
        "frame_ms_mean": float(frame_ms.mean()),
        "frame_ms_sd": float(frame_ms.std(ddof=1)) if len(frame_ms) > 1 else 0.0,
        "frame_ms_p95": float(np.quantile(frame_ms, 0.95)),
        "repeats_spread_pct": 100.0 * float(np.median(spread)),
        "means": means,
        "log": recorded.header,
    }
    if recorded.pictures:
        record["pictures"] = summarise_pictures(recorded.pictures)
    return record
