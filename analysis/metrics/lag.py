"""Lag: how old the picture is, how evenly the world moves, and how late a policy answers."""

import numpy as np

from ...base.arrays import FloatArray
from .measured_frames import MeasuredFrames
from .metric import metric
from .over_frames import frame_mean, frame_sd
from .over_time import time_mean, time_quantile
from .steps import find_steps


@metric("lag", "ms", "lower")
def lag_ms_mean(run: MeasuredFrames) -> float | None:
    """Mean over time of the time from the sample of the camera to the display of its frame.

    Source: lag of Wloka, Presence 4(1), 1995, without the input device; PresentMon DisplayLatency.
    """
    return time_mean(run.lag_ms, run.cost_weight_ms)


@metric("lag", "ms", "lower")
def lag_ms_p99(run: MeasuredFrames) -> float | None:
    """99th percentile over time of the time from the sample of the camera to its frame's display.

    Source: as lag_ms_mean.
    """
    return time_quantile(run.lag_ms, run.cost_weight_ms, 0.99)


@metric("lag", "ms", "lower")
def animation_error_ms_mean(run: MeasuredFrames) -> float | None:
    """Mean over frames, without sign, of step between camera samples minus step between displays.

    Source: PresentMon MsAnimationError, with the camera sample as start of the simulation.
    """
    return frame_mean(np.abs(run.animation_error_ms))


@metric("lag", "ms", "lower")
def settle_ms(run: MeasuredFrames) -> float | None:
    """Mean time from a step in visible load until the budget holds again.

    A step is a rise of full_gpu_ms by a quarter or more within 100 ms to above the budget.  The
    budget holds from a frame on if 9 of 10 frames of the next 250 ms stay within 1.1 times it.  A
    step that is never settled counts to the next step, 5 s, or the end: a lower bound.

    Source: settling time of control theory; lodbench's choice of step and band.
    """
    return frame_mean(_at_steps(run, "settle_ms"))


@metric("lag", "ratio", "lower")
def overshoot_ratio(run: MeasuredFrames) -> float | None:
    """Mean over steps in visible load of the largest work_ms until the budget has held, over it.

    Source: the "unavoidable overshoot" of feedback algorithms in Gobbetti and Bouvier,
    Time-critical multiresolution rendering of large complex models; steps as in settle_ms.
    """
    return frame_mean(_at_steps(run, "overshoot_ratio"))


@metric("lag", "%", "lower")
def prediction_error_pct_mean(run: MeasuredFrames) -> float | None:
    """Mean over frames, without sign, of predicted minus measured GPU time over measured.

    Source: estimate error in per cent, as the HLOD thesis reports it, here without sign; none
    where nothing is predicted.
    """
    return frame_mean(np.abs(prediction_error_pct(run)))


@metric("lag", "%", "lower")
def prediction_error_pct_sd(run: MeasuredFrames) -> float | None:
    """Sample standard deviation of predicted minus measured GPU time over measured, signed.

    Source: spread of the estimate error, as the HLOD thesis reports it.
    """
    return frame_sd(prediction_error_pct(run))


def prediction_error_pct(run: MeasuredFrames) -> FloatArray:
    """Return the signed error of each predicted GPU time, (n,); NaN where nothing was predicted."""
    measured = np.where(run["gpu_ms"] > 0.0, run["gpu_ms"], np.nan)
    return 100.0 * (run["predicted_gpu_ms"] - measured) / measured


def _at_steps(run: MeasuredFrames, attribute: str) -> FloatArray:
    values = np.full(len(run), np.nan)
    for step in find_steps(run):
        values[step.frame] = getattr(step, attribute)
    return values
