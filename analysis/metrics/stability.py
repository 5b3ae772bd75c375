"""Stability: how long frames take, and how much that varies.

``frame_ms`` is the interval between successive displays, as a viewer sees it.  These metrics go by
frames, as the tools do that define them; what a budget limits goes by time (see ``budget``).
"""

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .measured_frames import MeasuredFrames
from .metric import metric
from .over_frames import (
    fps_low_integral,
    fps_low_mean,
    fps_low_percentile,
    frame_mean,
    frame_quantile,
    frame_ratio,
    frame_sd,
    most,
)

_HITCH_MS, _HITCH_RATIO, _HITCH_DEAD_NS = 60.0, 1.5, 200_000_000
_STUTTER_FACTOR, _SPIKE_FACTOR = 2.5, 3.0
_REFRESH_MODES = ("vsync", "mailbox")


@metric("stability", "ms", "lower")
def frame_ms_mean(run: MeasuredFrames) -> float | None:
    """Mean interval between successive displays.

    Source: PresentMon MsBetweenDisplayChange; its mean is the inverse of the average frame rate.
    """
    return frame_mean(run.frame_ms)


@metric("stability", "ms", "lower")
def frame_ms_sd(run: MeasuredFrames) -> float | None:
    """Sample standard deviation of the interval between successive displays.

    Source: standard.
    """
    return frame_sd(run.frame_ms)


@metric("stability", "ms", "lower")
def frame_ms_p50(run: MeasuredFrames) -> float | None:
    """Median interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return frame_quantile(run.frame_ms, 0.50)


@metric("stability", "ms", "lower")
def frame_ms_p95(run: MeasuredFrames) -> float | None:
    """95th percentile of the interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return frame_quantile(run.frame_ms, 0.95)


@metric("stability", "ms", "lower")
def frame_ms_p99(run: MeasuredFrames) -> float | None:
    """99th percentile of the interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return frame_quantile(run.frame_ms, 0.99)


@metric("stability", "ms", "lower")
def frame_ms_max(run: MeasuredFrames) -> float | None:
    """Longest interval between successive displays.

    Source: standard.
    """
    return most(run.frame_ms)


@metric("stability", "fps", "higher")
def fps_low1_percentile(run: MeasuredFrames) -> float | None:
    """1 % low, percentile: 1000 over the 99th percentile of frame_ms.

    Source: PresentMon "1st Percentile FPS", MangoHud, CapFrameX P1.
    """
    return fps_low_percentile(run.frame_ms, 0.01)


@metric("stability", "fps", "higher")
def fps_low1_mean(run: MeasuredFrames) -> float | None:
    """1 % low, mean: 1000 over the mean of the frame_ms at or above their 99th percentile.

    Source: CapFrameX "1% Low Average", whose percentile is of type 8; GameBench, GamersNexus.
    """
    return fps_low_mean(run.frame_ms, 0.01)


@metric("stability", "fps", "higher")
def fps_low1_integral(run: MeasuredFrames) -> float | None:
    """1 % low, integral: 1000 over the frame_ms at which the slowest frames fill 1 % of all time.

    Source: RTSS and MSI Afterburner, CapFrameX "1% Low Integral".
    """
    return fps_low_integral(run.frame_ms, 0.01)


@metric("stability", "1/min", "lower")
def hitches_per_min(run: MeasuredFrames) -> float | None:
    """Frames of at least 60 ms and 1.5 times the frame before, 200 ms or more after the last such.

    Source: Unreal FPSChart: t.HitchFrameTimeThreshold, t.HitchVersusNonHitchRatio,
    t.HitchDeadTimeWindow, HPM.
    """
    return frame_ratio(np.where(hitch_flags(run), 60e3, 0.0), run.frame_ms)


@metric("stability", "fraction", "lower")
def stutter_time_fraction(run: MeasuredFrames) -> float | None:
    """Share of time in frames longer than 2.5 times their moving average.

    The average is of the last round(10 √mean) frames up to this one, where a frame of more than 3
    times the frame before counts as long as that one.

    Source: CapFrameX "Stuttering time", StutteringFactor 2.5.
    """
    times_ms = run.frame_ms
    stutters = times_ms > _STUTTER_FACTOR * moving_average_ms(times_ms)
    return frame_ratio(np.where(stutters, times_ms, 0.0), times_ms)


@metric("stability", "fraction", "lower")
def missed_vsync_fraction(run: MeasuredFrames) -> float | None:
    """Share of refreshes that showed no new frame, with vsync and mailbox.

    Source: Unreal FPSChart MVP, max(0, ⌊F·T⌋ − N) / ⌊F·T⌋, with both counted per displayed frame.
    """
    if run.header.display_mode not in _REFRESH_MODES:
        return None
    refreshes = np.round(run.frame_ms * run.header.refresh_hz * 1e-3)
    return frame_ratio(refreshes - 1.0, refreshes)


@metric("stability", "ms", "lower")
def frame_delta_ms_p95(run: MeasuredFrames) -> float | None:
    """95th percentile of the difference, without sign, between successive frame_ms.

    Source: CapFrameX frame-time variance |x_i − x_(i−1)|; MASD is its mean.
    """
    return frame_quantile(np.abs(run.frame_ms - run.previous_frame_ms), 0.95)


def hitch_flags(run: MeasuredFrames) -> BoolArray:
    """Return which frames are hitches by Unreal's rule, (n,)."""
    slow = run.frame_ms >= _HITCH_MS
    slow &= run.frame_ms >= _HITCH_RATIO * run.previous_frame_ms
    flags = np.zeros(len(run), dtype=np.bool_)
    last_ns = -_HITCH_DEAD_NS
    for frame in np.flatnonzero(slow):
        at_ns = int(run["display_ns"][frame])
        if at_ns - last_ns >= _HITCH_DEAD_NS:
            flags[frame] = True
            last_ns = at_ns
    return flags


def moving_average_ms(times_ms: FloatArray) -> FloatArray:
    """Return CapFrameX's moving average of frame times, (n,); NaN where the frame has no time."""
    average = np.full(len(times_ms), np.nan)
    at = np.flatnonzero(~np.isnan(times_ms))
    if not len(at):
        return average
    x = times_ms[at]
    before = np.concatenate((x[:1], x[:-1]))
    total = np.concatenate(((0.0,), np.cumsum(np.where(x > _SPIKE_FACTOR * before, before, x))))
    end = np.arange(1, len(x) + 1)
    start = np.maximum(end - max(round(10.0 * float(np.sqrt(x.mean()))), 1), 0)
    average[at] = (total[end] - total[start]) / (end - start)
    return average
