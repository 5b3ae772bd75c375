"""Statistics over frames, as the tools take them that define such metrics; NaN has no value."""

import numpy as np

from ...base.arrays import FloatArray


def frame_mean(values: FloatArray) -> float | None:
    """Return the arithmetic mean, None of nothing."""
    known = _known(values)
    return float(known.mean()) if len(known) else None


def frame_sd(values: FloatArray) -> float | None:
    """Return the sample standard deviation, with N − 1; None of fewer than two."""
    known = _known(values)
    return float(known.std(ddof=1)) if len(known) > 1 else None


def frame_quantile(values: FloatArray, q: float) -> float | None:
    """Return the quantile of type 7 (linear at q(N − 1)), as PresentMon's; None of nothing."""
    known = _known(values)
    return float(np.quantile(known, q)) if len(known) else None


def most(values: FloatArray) -> float | None:
    """Return the largest value, None of nothing."""
    known = _known(values)
    return float(known.max()) if len(known) else None


def frame_ratio(numerator: FloatArray, denominator: FloatArray) -> float | None:
    """Return sum over sum, of the frames that have both; None where the latter is 0."""
    known = ~(np.isnan(numerator) | np.isnan(denominator))
    below = float(denominator[known].sum())
    return float(numerator[known].sum()) / below if below > 0.0 else None


def fps_low_percentile(times_ms: FloatArray, share: float) -> float | None:
    """Return the frame rate of the (1 − share) quantile of frame times."""
    slow_ms = frame_quantile(times_ms, 1.0 - share)
    return 1e3 / slow_ms if slow_ms else None


def fps_low_mean(times_ms: FloatArray, share: float) -> float | None:
    """Return the frame rate of the mean of frame times at or above their (1 − share) quantile.

    The quantile is of type 8, which CapFrameX (by MathNet) takes.
    """
    known = _known(times_ms)
    if not len(known):
        return None
    least_ms = np.quantile(known, 1.0 - share, method="median_unbiased")
    slow_ms = float(known[known >= least_ms].mean())
    return 1e3 / slow_ms if slow_ms else None


def fps_low_integral(times_ms: FloatArray, share: float) -> float | None:
    """Return the frame rate of the frame at which the slowest ones add up to a share of time."""
    slowest_first = np.sort(_known(times_ms))[::-1]
    reached = np.cumsum(slowest_first)
    if not len(reached) or not reached[-1]:
        return None
    return float(1e3 / slowest_first[np.argmax(reached >= share * reached[-1])])


def _known(values: FloatArray) -> FloatArray:
    return values[~np.isnan(values)]
