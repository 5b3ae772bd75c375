"""Statistics of per-frame values that can be taken of any resample of the frames.

Every metric is a `Statistic`: values that belong to frames, and a reduction of them to one
number.  The bootstrap takes the reduction of many resamples at once, as rows of one matrix; NaN
marks a frame that has no value (a frame never shown has no lag), and padding of rows.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray

_LARGEST_MATRIX = 2_000_000
"""Values of one matrix of resamples: 16 MB, so that long runs do not exhaust memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Statistic:
    """Per-frame values and their reduction.

    Attributes
    ----------
    series : tuple of (n,) float64
        NaN where a frame has no value.
    reduce : callable
        From one (R, m) matrix for each series to (R,).
    """

    series: tuple[FloatArray, ...]
    reduce: Callable[..., FloatArray]

    @property
    def support(self) -> int:
        """Number of frames that have a value."""
        return int(np.count_nonzero(~np.isnan(self.series[0])))

    def value(self) -> float | None:
        """Return the statistic of all frames, or None if no frame has a value."""
        if not self.support:
            return None
        value = float(self.reduce(*(series[np.newaxis] for series in self.series))[0])
        return value if np.isfinite(value) else None

    def resampled(self, rows: IntArray) -> FloatArray:
        """Return the statistic of each resample, (R,).

        Parameters
        ----------
        rows : (R, m) int32
            Frames of each resample, `n` where a row is padded.
        """
        padded = tuple(np.append(series, np.nan) for series in self.series)
        chunks = -(-rows.size // _LARGEST_MATRIX)
        parts = [
            self.reduce(*(series[part] for series in padded))
            for part in np.array_split(rows, max(chunks, 1))
        ]
        return np.concatenate(parts)


def mean(series: FloatArray) -> Statistic:
    """Arithmetic mean."""
    return Statistic((series,), _mean)


def sd(series: FloatArray) -> Statistic:
    """Sample standard deviation, with N − 1."""
    return Statistic((series,), _sd)


def maximum(series: FloatArray) -> Statistic:
    """Largest value."""
    return Statistic((series,), partial(_quantile, q=1.0))


def quantile(series: FloatArray, q: float) -> Statistic:
    """Quantile of type 7 (linear interpolation at q(N − 1)), as PresentMon's and numpy's."""
    return Statistic((series,), partial(_quantile, q=q))


def ratio(numerator: FloatArray, denominator: FloatArray) -> Statistic:
    """Sum over sum, of the frames that have both."""
    absent = np.isnan(numerator) | np.isnan(denominator)
    return Statistic(
        (np.where(absent, np.nan, numerator), np.where(absent, np.nan, denominator)), _ratio
    )


def fps_of_quantile(times_ms: FloatArray, q: float) -> Statistic:
    """Frame rate of a quantile of frame times."""
    return Statistic((times_ms,), partial(_fps_of_quantile, q=q))


def fps_low_mean(times_ms: FloatArray, share: float) -> Statistic:
    """Frame rate of the mean of the frame times at or above their (1 − share) quantile, type 8."""
    return Statistic((times_ms,), partial(_fps_low_mean, share=share))


def fps_low_integral(times_ms: FloatArray, share: float) -> Statistic:
    """Frame rate of the frame at which the slowest frames add up to a share of all time."""
    return Statistic((times_ms,), partial(_fps_low_integral, share=share))


def _count(x: FloatArray) -> NDArray[np.intp]:
    return np.count_nonzero(~np.isnan(x), axis=1)


def _divide(numerator: FloatArray, denominator: FloatArray | NDArray[np.intp]) -> FloatArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient: FloatArray = np.true_divide(numerator, denominator)
    quotient[denominator <= 0] = np.nan
    return quotient


def _mean(x: FloatArray) -> FloatArray:
    return _divide(np.nansum(x, axis=1), _count(x))


def _sd(x: FloatArray) -> FloatArray:
    deviation = x - _mean(x)[:, np.newaxis]
    return np.sqrt(_divide(np.nansum(deviation * deviation, axis=1), _count(x) - 1))


def _quantile(x: FloatArray, q: float, *, median_unbiased: bool = False) -> FloatArray:
    """Quantile of type 7, or of type 8, which CapFrameX (by MathNet) takes."""
    ordered = np.sort(x, axis=1)  # NaN last
    last = np.maximum(_count(x) - 1, 0)
    rank = q * last
    if median_unbiased:
        rank = np.clip((last + 4.0 / 3.0) * q - 2.0 / 3.0, 0.0, last)
    below = np.floor(rank).astype(np.intp)
    above = np.ceil(rank).astype(np.intp)
    rows = np.arange(len(x))
    low = ordered[rows, below]
    return low + (rank - below) * (ordered[rows, above] - low)


def _fps_of_quantile(x: FloatArray, q: float) -> FloatArray:
    return 1e3 / _quantile(x, q)


def _ratio(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    return _divide(np.nansum(numerator, axis=1), np.nansum(denominator, axis=1))


def _fps_low_mean(x: FloatArray, share: float) -> FloatArray:
    slowest = x >= _quantile(x, 1.0 - share, median_unbiased=True)[:, np.newaxis]
    return 1e3 * _divide(
        np.count_nonzero(slowest, axis=1).astype(np.float64), np.where(slowest, x, 0.0).sum(axis=1)
    )


def _fps_low_integral(x: FloatArray, share: float) -> FloatArray:
    slowest_first = -np.sort(-x, axis=1)
    reached = np.nancumsum(slowest_first, axis=1)
    at = np.argmax(reached >= share * reached[:, -1:], axis=1)
    return 1e3 / slowest_first[np.arange(len(x)), at]
