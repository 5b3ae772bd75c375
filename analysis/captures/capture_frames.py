"""The frames of a capture as the metrics of replays take them, so that both mean the same."""

from collections.abc import Mapping

import numpy as np

from ...base.arrays import FloatArray
from ...sim.frame_log import COUNTS, TIMES, FrameLog, LogHeader
from ...traces.logs.render_log import RenderLog
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import find_metric
from ..metrics.over_frames import frame_mean, frame_quantile

METRICS = (
    *("frame_ms_mean", "frame_ms_sd", "frame_ms_p50", "frame_ms_p95", "frame_ms_p99"),
    *("frame_ms_max", "fps_low1_percentile", "fps_low1_mean", "fps_low1_integral"),
    *("hitches_per_min", "stutter_time_fraction", "frame_delta_ms_p95"),
)
"""Of a replay's metrics, those that times of frames alone can have."""

AVERAGE_FPS = "average_fps"

_NS = 1e6
_TOO_LONG_MS = 1e9  # of the clock, that frames of all captures fit into


def intervals_of(log: RenderLog) -> dict[str, FloatArray]:
    """Return the series of frame intervals that a capture has, in ms, without what is missing.

    ``frames``: from frame to frame, as the tool has it; ``displays``: between changes of what the
    screen shows, where the tool measured that.
    """
    series: dict[str, FloatArray] = {}
    if log.frame_ms is not None:
        series["frames"] = _good(log.frame_ms)
    if log.timings is not None:
        series["displays"] = _good(log.timings.between_display_change_ms)
    return {name: values for name, values in series.items() if len(values)}


def _good(values: FloatArray) -> FloatArray:
    return values[(values > 0.0) & (values < _TOO_LONG_MS)]


def measured(interval_ms: FloatArray) -> MeasuredFrames:
    """Return frames whose displays lie these intervals apart, (n,); the first begins at 0."""
    display_ns = np.zeros(len(interval_ms) + 1, dtype=np.int64)
    display_ns[1:] = np.rint(np.cumsum(interval_ms) * _NS)
    # One column and one number, seen as tables: intervals are scored a thousand times over.
    times_ns = np.broadcast_to(display_ns[:, np.newaxis], (len(display_ns), len(TIMES)))
    counts = np.broadcast_to(np.nan, (len(display_ns), len(COUNTS)))
    header = LogHeader("", "", "", "", 0.0, 0, "immediate", 0.0, 0.0)
    return MeasuredFrames(FrameLog(header, times_ns, counts))


def score(interval_ms: FloatArray) -> dict[str, float | None]:
    """Return the metrics of a series of intervals, (n,) with n >= 1, by id."""
    run = measured(interval_ms)
    average = 1e3 * len(interval_ms) / float(interval_ms.sum())
    return {AVERAGE_FPS: average, **{name: find_metric(name)(run) for name in METRICS}}


def busy_scores(log: RenderLog) -> dict[str, dict[str, float | None]]:
    """Return mean, median, 95th and 99th percentile of the busy times that a capture has."""
    scores: dict[str, dict[str, float | None]] = {}
    for name in ("gpu_ms", "cpu_ms"):
        values = getattr(log, name)
        if values is not None and len(good := _good(values)):
            scores[name] = {"mean": frame_mean(good)} | {
                f"p{q}": frame_quantile(good, q / 100.0) for q in (50, 95, 99)
            }
    return scores


BOUND = 0.9
"""Part of the frame that a processor is busy for, from which the frame is bound by it."""


def bound_shares(log: RenderLog) -> Mapping[str, float] | None:
    """Return the shares of time in frames bound by GPU, by CPU, and by neither, or None.

    A frame is bound by the processor that is busier if that is busy for 0.9 of it; by neither where
    both wait, as for a refresh.  None where the capture lacks one of the three times.
    """
    if log.frame_ms is None or log.gpu_ms is None or log.cpu_ms is None:
        return None
    known = (log.frame_ms > 0.0) & np.isfinite(log.gpu_ms) & np.isfinite(log.cpu_ms)
    frame, gpu, cpu = log.frame_ms[known], log.gpu_ms[known], log.cpu_ms[known]
    total = float(frame.sum())
    if total <= 0.0:
        return None
    busy = np.maximum(gpu, cpu) >= BOUND * frame
    by_gpu = float(frame[busy & (gpu >= cpu)].sum()) / total
    by_cpu = float(frame[busy & (gpu < cpu)].sum()) / total
    return {"gpu": by_gpu, "cpu": by_cpu, "neither": max(0.0, 1.0 - by_gpu - by_cpu)}
