"""The frame that is worst by a metric, and where the camera was."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import find_metric


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
        What the metric takes from this frame.
    camera_m : (x, y, z)
    """

    seed: int
    frame: int
    time_s: float
    value: float
    camera_m: tuple[float, float, float]


def find_worst(logs: Sequence[FrameLog], warmup: int, metric_id: str) -> WorstFrame | None:
    """Return the worst frame of all replays, or None where no frame bears on the metric."""
    metric = find_metric(metric_id)
    # A rate in frames a second is made of times, whose worst is the longest.
    largest = metric.better == "lower" or metric.unit == "fps"
    worst: tuple[float, FrameLog, int] | None = None
    for log in logs:
        statistic = metric(MeasuredFrames(log, warmup))
        if statistic is None or not statistic.support:
            continue
        values = _per_frame(statistic.series)
        badness = np.where(np.isnan(values), -np.inf, values if largest else -values)
        at = int(badness.argmax())
        if worst is None or badness[at] > worst[0]:
            worst = float(badness[at]), log, warmup + at
    if worst is None or not np.isfinite(worst[0]):
        return None
    badness, log, frame = worst
    x, y, z = (float(log[axis][frame]) for axis in ("x_m", "y_m", "z_m"))
    return WorstFrame(
        log.header.seed,
        frame,
        float(log["input_ns"][frame]) * 1e-9,
        badness if largest else -badness,
        (x, y, z),
    )


def _per_frame(series: tuple[FloatArray, ...]) -> FloatArray:
    if len(series) == 1:
        return series[0]
    top, bottom = series
    return np.divide(top, bottom, out=np.full(len(top), np.nan), where=bottom > 0.0)
