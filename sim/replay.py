"""Replay of a camera trace through the pipeline under one policy."""

from collections.abc import Callable

import numpy as np

from ..models.machine.hardware import Display, HardwareProfile
from ..models.scene.scene import Scene
from ..policies.protocol import Policy
from ..traces.cameras.camera_trace import CameraTrace
from .frame_log import TIMES, FrameLog, LogHeader
from .level_history import LevelRecorder
from .machine.simulated_machine import Machine
from .pipeline.pipeline import FrameSource, Pipeline
from .policy_frames import PolicyFrames
from .replay_options import ReplayOptions


def replay(
    policy: Policy,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    *,
    name: str,
    machine: Machine | None = None,
    beat: Callable[[int], None] | None = None,
    keeps_levels: bool = False,
    make_pipeline: Callable[[FrameSource, Display, int], Pipeline] = Pipeline,
) -> FrameLog:
    """Replay `trace` through `scene` on `hardware` under `policy`; return its frame log.

    The replay ends with the trace or after `options.frames` frames.  The same arguments give the
    same bytes, unless a `machine` that measures stands in for the simulated one.
    `beat` is called with the number of each frame as it begins: a watcher's sign of life.
    `keeps_levels` asks for the level of each node over time (`FrameLog.levels`).
    `make_pipeline` returns another pipeline than the simulated one, whose times are measured.

    Raises
    ------
    InputError
        If the trace takes more than `MAX_FRAMES` frames, which are not limited.
    PolicyError
        If the policy raises or a selection breaks its contract.
    """
    options.require_end(trace.name, trace.duration_s * hardware.display.refresh_hz)
    levels = LevelRecorder(scene) if keeps_levels else None
    frames = PolicyFrames(policy, scene, trace, hardware, options, name, machine, beat, levels)
    pipeline = make_pipeline(frames, hardware.display, hardware.frames_in_flight)
    frames.attach(pipeline)
    pipeline.run()
    header = LogHeader(
        name,
        scene.name,
        trace.name,
        hardware.name,
        options.budget_ms,
        options.seed,
        hardware.display.mode,
        hardware.display.refresh_hz,
        options.memory_bytes or hardware.memory_bytes,
        policy.capabilities.future,
        options.visible_px,
    )
    times_ns = np.empty((len(pipeline.input_ns), len(TIMES)), dtype=np.int64)
    for column, time in enumerate(TIMES):
        np.maximum(
            np.frombuffer(getattr(pipeline, time), dtype=np.int64), -1, out=times_ns[:, column]
        )
    history = None if levels is None else levels.history()
    return FrameLog(header, times_ns, frames.counts(), frames.drawn_by_depth(), history)
