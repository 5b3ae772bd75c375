"""Runs of the frame pipeline with scripted costs, for tests of what is made of frame logs."""

import numpy as np
from numpy.typing import NDArray

from lodbench.models.hardware import Display, DisplayMode
from lodbench.sim.frame_log import COUNTS, TIMES, FrameLog, LogHeader
from lodbench.sim.pipeline import Pipeline


class Script:
    """A source of frames whose costs are given."""

    def __init__(self, cpu_ns: NDArray[np.int64], gpu_ns: NDArray[np.int64]) -> None:
        self.costs = list(zip(cpu_ns.tolist(), gpu_ns.tolist(), strict=True))

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Return the costs of a frame, None after the last."""
        return self.costs[frame] if frame < len(self.costs) else None


def run_pipeline(
    mode: DisplayMode, frames: int = 400, seed: int = 1, policy: str = "feedback:gain=0.5,delay=2"
) -> FrameLog:
    """Return the log of frames with skewed random costs, a few of them long, on 3 images."""
    rng = np.random.default_rng(seed)
    cpu_ns = rng.lognormal(np.log(4e6), 0.3, frames).astype(np.int64)
    gpu_ns = rng.lognormal(np.log(9e6), 0.4, frames).astype(np.int64)
    gpu_ns[rng.random(frames) < 0.02] *= 6
    display = Display(mode=mode, refresh_hz=90.0, vrr_min_hz=40.0)
    pipeline = Pipeline(Script(cpu_ns, gpu_ns), display, 2)
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
    header = LogHeader(policy, "scene", "trace", "machine", 10.0, 3, mode, 90.0, 1e9)
    return FrameLog(header, times.astype(np.int64), counts)
