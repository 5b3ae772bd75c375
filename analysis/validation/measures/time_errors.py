"""Errors of predicted frame times, frame by frame."""

from math import isfinite

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..validation_result import ErrorSummary

ADAPT_RATE = 0.2
"""Share of the way to measured over predicted time that the factor moves, as in `fitting.md`."""


def summarise(predicted_ms: FloatArray, measured_ms: FloatArray) -> ErrorSummary:
    """Return errors of (n,) predictions; NaN on either side is left out.

    Raises `InputError` if fewer than two frames are left.
    """
    error = 100.0 * (predicted_ms / measured_ms - 1.0)  # no measured time is 0
    error = error[np.isfinite(error)]
    if len(error) < 2:
        raise InputError(
            f"validation: expected at least two frames to compare, got {len(error)}; take a longer "
            "trace or lower --warmup"
        )
    low, middle, high = np.quantile(error, (0.05, 0.5, 0.95)).tolist()
    mean, sd = float(error.mean()), float(error.std(ddof=1))
    return ErrorSummary(len(error), mean, sd, low, middle, high)


def adapted_ms(
    predicted_ms: FloatArray, measured_ms: FloatArray, rate: float = ADAPT_RATE
) -> FloatArray:
    """Return predictions times the v_time that the frames before have led to, (n,).

    As `VTime` of `policies.shared.times` does with one frame in flight: each frame is predicted
    before it is measured.  The idea is the HLOD thesis', the rate ours.  A frame that is predicted
    to take no time teaches nothing.
    """
    known = predicted_ms > 0.0
    out = np.full(len(known), np.nan)
    ratios: list[float] = np.divide(measured_ms, predicted_ms, out=out, where=known).tolist()
    factor, factors = 1.0, np.empty(len(ratios))
    for frame, ratio in enumerate(ratios):
        factors[frame] = factor
        if isfinite(ratio):
            factor += rate * (ratio - factor)
    return predicted_ms * factors


def at_times(time_s: FloatArray, values: FloatArray, wanted_s: FloatArray) -> FloatArray:
    """Return a series at the times of another's frames, linear between its own, NaN outside."""
    return np.interp(wanted_s, time_s, values, left=np.nan, right=np.nan)


def at_nearest(time_s: FloatArray, values: FloatArray, wanted_s: FloatArray) -> FloatArray:
    """Return a series' values nearest to the times of another's frames, NaN outside of its own.

    A value between two would have less noise than a frame has.
    """
    if not len(time_s):
        return np.full(len(wanted_s), np.nan)
    after = np.clip(np.searchsorted(time_s, wanted_s), 1, max(len(time_s) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time_s) - 1)
    nearer = np.where(wanted_s - time_s[before] <= time_s[after] - wanted_s, before, after)
    outside = (wanted_s < time_s[0]) | (wanted_s > time_s[-1])
    return np.where(outside, np.nan, values[nearer])
