"""The frame that is worst by a metric, and where the camera was."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import MeasuredFrames


@dataclass(frozen=True, slots=True)
class WorstFrame:
    """A frame of one of the replays.

    Attributes
    ----------
    seed : int
    frame : int
        From 0, warm-up included.
    time_s : float
        Of the trace, when the camera was sampled.
    value : float
        What the metric is made of, in this frame.
    camera_m : (x, y, z)
    """

    seed: int
    frame: int
    time_s: float
    value: float
    camera_m: tuple[float, float, float]


def find_worst(logs: Sequence[FrameLog], warmup_s: float, metric_id: str) -> WorstFrame | None:
    """Return the worst frame of all replays, or None where no single frame is to blame."""
    series = next((get for start, get in _SERIES.items() if metric_id.startswith(start)), None)
    if series is None:
        return None
    worst: tuple[float, FrameLog, int] | None = None
    for log in logs:
        run = MeasuredFrames(log, warmup_s)
        values = np.nan_to_num(series(run), nan=-np.inf)
        at = int(values.argmax())
        if worst is None or values[at] > worst[0]:
            worst = float(values[at]), log, run.first + at
    if worst is None or not np.isfinite(worst[0]):
        return None
    value, log, frame = worst
    x, y, z = (float(log[axis][frame]) for axis in ("x_m", "y_m", "z_m"))
    seconds = float(log["input_ns"][frame]) * 1e-9
    return WorstFrame(log.header.seed, frame, seconds, value, (x, y, z))


_SERIES: dict[str, Callable[[MeasuredFrames], FloatArray]] = {
    **dict.fromkeys(
        ("work_ms", "over_budget", "longest_over", "utilisation"), lambda run: run.work_ms
    ),
    **dict.fromkeys(
        ("frame_ms", "fps_low1", "hitches", "stutter", "missed_vsync"), lambda run: run.frame_ms
    ),
    "lag_ms": lambda run: run.lag_ms,
    "visible_pops": lambda run: run["visible_pops"],
    "toggles": lambda run: run["toggles"],
    "reversals": lambda run: run["reversals"],
    "popping_px": lambda run: run["popping_px"],
    "visible_error_px": lambda run: run["sse_px_p95"],
    "visible_error_area_px": lambda run: run["visible_error_area_px"],
    "sse_px_p95": lambda run: run["sse_px_p95"],
    "sse_px_worst": lambda run: run["sse_px_max"],
    "missing_objects": lambda run: run["missing"],
    "select_ms": lambda run: run["select_ms"],
    "triangles": lambda run: run["triangles"],
}
"""What of a frame the metrics of these names are made of, largest where it is worst."""
