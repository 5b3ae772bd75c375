"""Stability: how long frames take, how much that varies, and how often it breaks the budget.

``frame_ms`` is the interval between successive displays, as a viewer sees it; ``work_ms`` is the
larger of CPU and GPU time, which no refresh quantises.  Budget metrics judge ``work_ms``.
"""

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .measured_frames import MeasuredFrames
from .metric import metric
from .statistic import (
    Statistic,
    fps_low_integral,
    fps_low_mean,
    fps_of_quantile,
    maximum,
    mean,
    quantile,
    ratio,
    sd,
)

_HITCH_MS, _HITCH_RATIO, _HITCH_DEAD_NS = 60.0, 1.5, 200_000_000
_STUTTER_FACTOR, _SPIKE_FACTOR = 2.5, 3.0
_REFRESH_MODES = ("vsync", "mailbox")


@metric("stability", "ms", "lower")
def frame_ms_mean(run: MeasuredFrames) -> Statistic:
    """Mean interval between successive displays.

    Source: PresentMon MsBetweenDisplayChange; its mean is the inverse of the average frame rate.
    """
    return mean(run.frame_ms)


@metric("stability", "ms", "lower")
def frame_ms_sd(run: MeasuredFrames) -> Statistic:
    """Sample standard deviation of the interval between successive displays.

    Source: standard.
    """
    return sd(run.frame_ms)


@metric("stability", "ms", "lower")
def frame_ms_p50(run: MeasuredFrames) -> Statistic:
    """Median interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return quantile(run.frame_ms, 0.50)


@metric("stability", "ms", "lower")
def frame_ms_p95(run: MeasuredFrames) -> Statistic:
    """95th percentile of the interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return quantile(run.frame_ms, 0.95)


@metric("stability", "ms", "lower")
def frame_ms_p99(run: MeasuredFrames) -> Statistic:
    """99th percentile of the interval between successive displays.

    Source: PresentMon percentiles, linear interpolation (type 7).
    """
    return quantile(run.frame_ms, 0.99)


@metric("stability", "ms", "lower")
def frame_ms_max(run: MeasuredFrames) -> Statistic:
    """Longest interval between successive displays.

    Source: standard.
    """
    return maximum(run.frame_ms)


@metric("stability", "ms", "lower")
def work_ms_mean(run: MeasuredFrames) -> Statistic:
    """Mean of the larger of CPU and GPU time.

    Source: twin of frame_ms_mean on the time that no refresh quantises.
    """
    return mean(run.work_ms)


@metric("stability", "ms", "lower")
def work_ms_sd(run: MeasuredFrames) -> Statistic:
    """Sample standard deviation of the larger of CPU and GPU time.

    Source: twin of frame_ms_sd; Unity's StableFrameMode steers by its variance.
    """
    return sd(run.work_ms)


@metric("stability", "ms", "lower")
def work_ms_p50(run: MeasuredFrames) -> Statistic:
    """Median of the larger of CPU and GPU time.

    Source: twin of frame_ms_p50.
    """
    return quantile(run.work_ms, 0.50)


@metric("stability", "ms", "lower")
def work_ms_p95(run: MeasuredFrames) -> Statistic:
    """95th percentile of the larger of CPU and GPU time.

    Source: twin of frame_ms_p95.
    """
    return quantile(run.work_ms, 0.95)


@metric("stability", "ms", "lower")
def work_ms_p99(run: MeasuredFrames) -> Statistic:
    """99th percentile of the larger of CPU and GPU time.

    Source: twin of frame_ms_p99.
    """
    return quantile(run.work_ms, 0.99)


@metric("stability", "ms", "lower")
def work_ms_max(run: MeasuredFrames) -> Statistic:
    """Largest CPU or GPU time of a frame.

    Source: twin of frame_ms_max.
    """
    return maximum(run.work_ms)


@metric("stability", "fps", "higher")
def fps_low1_percentile(run: MeasuredFrames) -> Statistic:
    """1 % low, percentile: 1000 over the 99th percentile of frame_ms.

    Source: PresentMon "1st Percentile FPS", MangoHud, CapFrameX P1.
    """
    return fps_of_quantile(run.frame_ms, 0.99)


@metric("stability", "fps", "higher")
def fps_low1_mean(run: MeasuredFrames) -> Statistic:
    """1 % low, mean: 1000 over the mean of the frame_ms at or above their 99th percentile.

    Source: CapFrameX "1% Low Average", whose percentile is of type 8; GameBench, GamersNexus.
    """
    return fps_low_mean(run.frame_ms, 0.01)


@metric("stability", "fps", "higher")
def fps_low1_integral(run: MeasuredFrames) -> Statistic:
    """1 % low, integral: 1000 over the frame_ms at which the slowest frames fill 1 % of all time.

    Source: RTSS and MSI Afterburner, CapFrameX "1% Low Integral".
    """
    return fps_low_integral(run.frame_ms, 0.01)


@metric("stability", "1/min", "lower")
def hitches_per_min(run: MeasuredFrames) -> Statistic:
    """Frames of at least 60 ms and 1.5 times the frame before, 200 ms or more after the last such.

    Source: Unreal FPSChart: t.HitchFrameTimeThreshold, t.HitchVersusNonHitchRatio,
    t.HitchDeadTimeWindow, HPM.
    """
    return ratio(np.where(hitch_flags(run), 60e3, 0.0), run.frame_ms)


@metric("stability", "fraction", "lower")
def stutter_time_fraction(run: MeasuredFrames) -> Statistic:
    """Share of time in frames longer than 2.5 times their moving average.

    The average is of the last round(10 √mean) frames up to this one, where a frame of more than 3
    times the frame before counts as long as that one.

    Source: CapFrameX "Stuttering time", StutteringFactor 2.5.
    """
    times_ms = run.frame_ms
    stutters = times_ms > _STUTTER_FACTOR * moving_average_ms(times_ms)
    return ratio(np.where(stutters, times_ms, 0.0), times_ms)


@metric("stability", "fraction", "lower")
def over_budget_fraction(run: MeasuredFrames) -> Statistic:
    """Share of frames whose work_ms exceeds the budget.

    Source: deadline miss ratio of soft real-time systems.
    """
    return mean((run.work_ms > run.header.budget_ms).astype(np.float64))


@metric("stability", "ratio", "lower")
def over_budget_max_ratio(run: MeasuredFrames) -> Statistic:
    """Largest work_ms over the budget; at most 1 if the budget always held.

    Source: worst case of the deadline miss ratio.
    """
    return maximum(run.work_ms / run.header.budget_ms)


@metric("stability", "frames", "lower")
def longest_over_budget_frames(run: MeasuredFrames) -> Statistic:
    """Longest run of successive frames whose work_ms exceeds the budget.

    Source: lodbench; a run of misses is seen where a single one is not.
    """
    return maximum(run_lengths(run.work_ms > run.header.budget_ms))


@metric("stability", "fraction", "lower")
def missed_vsync_fraction(run: MeasuredFrames) -> Statistic | None:
    """Share of refreshes that showed no new frame, with vsync and mailbox.

    Source: Unreal FPSChart MVP, max(0, ⌊F·T⌋ − N) / ⌊F·T⌋, with both counted per displayed frame.
    """
    if run.header.display_mode not in _REFRESH_MODES:
        return None
    refreshes = np.round(run.frame_ms * run.header.refresh_hz * 1e-3)
    return ratio(refreshes - 1.0, refreshes)


@metric("stability", "ms", "lower")
def frame_delta_ms_p95(run: MeasuredFrames) -> Statistic:
    """95th percentile of the difference, without sign, between successive frame_ms.

    Source: CapFrameX frame-time variance |x_i − x_(i−1)|; MASD is its mean.
    """
    return quantile(np.abs(run.frame_ms - run.previous_frame_ms), 0.95)


@metric("stability", "ratio", "lower")
def utilisation(run: MeasuredFrames) -> Statistic:
    """Mean work_ms over the budget; what a low value leaves unused shows in benefit_ratio.

    Source: utilisation of queueing theory.
    """
    return mean(run.work_ms / run.header.budget_ms)


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


def run_lengths(flags: BoolArray) -> FloatArray:
    """Return for each frame the length of the run of set flags that it lies in, 0 outside, (n,)."""
    change = np.flatnonzero(np.diff(flags)) + 1
    edges = np.concatenate(((0,), change, (len(flags),)))
    lengths = np.repeat(np.diff(edges), np.diff(edges)).astype(np.float64)
    return np.where(flags, lengths, 0.0)
