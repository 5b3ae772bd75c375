"""How heavy trials through a scene are for a policy, each frame weighed by its time on screen."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lodbench.base.arrays import FloatArray
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import replay
from lodbench.sim.replay_options import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

BUDGET_MS = 1000.0 / 60.0


@dataclass(frozen=True, slots=True)
class TrialLoad:
    """Of one policy over paths, (n,) each: work over budget, error, and the speed of the replay."""

    mean: FloatArray
    p99: FloatArray
    error_px: FloatArray
    frames_per_s: FloatArray


def weigh_trials(policy: str, scene: Scene, paths: Sequence[CameraTrace]) -> TrialLoad:
    """Replay a policy along paths on `desktop-assumed` at 60 Hz; return what it needs."""
    profile = load_hardware("desktop-assumed")
    hardware = replace(profile, display=replace(profile.display, mode="vsync", refresh_hz=60.0))
    rows: list[tuple[float, ...]] = []
    for path in paths:
        spec = parse_policy(policy)
        start = time.perf_counter()
        log = replay(
            spec.make(), scene, path, hardware, ReplayOptions(budget_ms=BUDGET_MS), name=spec.label
        )
        rows.append((*_weigh(log), len(log) / (time.perf_counter() - start)))
    return TrialLoad(*np.array(rows).T)


def _weigh(log: FrameLog) -> tuple[float, float, float]:
    """Return mean and 99th percentile of work over budget, and mean error (px), over time."""
    shown = np.diff(log["display_ns"]).astype(np.float64)
    work = np.maximum(log["cpu_ms"], log["gpu_ms"])[1:] / BUDGET_MS
    rising = np.argsort(work)
    share = np.cumsum(shown[rising]) / shown.sum()
    p99 = float(work[rising][np.searchsorted(share, 0.99)])
    error = np.average(log["sse_px_p95"][:-1], weights=shown)
    return float(np.average(work, weights=shown)), p99, float(error)
