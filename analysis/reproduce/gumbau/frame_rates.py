"""Replays of LODManager's walks, by position on the path."""

import numpy as np

from ....models.scene.scene_catalog import load_scene
from ....policies.registry import parse_policy
from ....sim.frame_log import FrameLog
from ....sim.replay import replay
from ....sim.replay_options import ReplayOptions
from ...study.engine.task import Beat
from ...study.stages import find_stage
from ..trial import Numbers
from .machine import machine

_BUDGET_MS = 33.3  # of a policy that steers by it; feedback is off
SETTLED_S = 1.0
"""Beginning of a path that does not count: everything is extracted for the first time there."""


def measure(
    *,
    scene: str,
    path: str,
    seed: int,
    seconds: float,
    policy: str,
    call_us: float,
    changed_ns: float,
    whole: bool,
    beat: Beat,
) -> Numbers:
    """Return frame rates and triangles in each second of the path, and what a frame did."""
    field = load_scene(scene)
    trace = find_stage(field).move(path, seconds + SETTLED_S, seed)
    spec = parse_policy(policy)
    hardware = machine(call_us, changed_ns, whole=whole)
    options = ReplayOptions(budget_ms=_BUDGET_MS, seed=seed)
    log = replay(spec.make(), field, trace, hardware, options, name=spec.label, beat=beat)
    return numbers_of(log, round(seconds))


def numbers_of(log: FrameLog, seconds: int) -> Numbers:
    """Return what the experiments judge of a replay."""
    at = log["input_ns"] * 1e-9 - SETTLED_S
    counts = (at >= 0.0) & (at < seconds)
    second = np.floor(at[counts]).astype(np.intp)
    frames = np.bincount(second, minlength=seconds)
    triangles = np.bincount(second, log["triangles"][counts], minlength=seconds)
    means = {
        name: float(log[name][counts].mean())
        for name in (
            "levels_extracted",
            "triangles_changed",
            "bytes_uploaded",
            "levels_borrowed",
            "visible",
            "select_ms",
            "cpu_ms",
            "gpu_ms",
        )
    }
    return {
        "fps": frames.astype(np.float64).tolist(),
        "triangles": (triangles / np.maximum(frames, 1)).tolist(),
        **means,
    }
