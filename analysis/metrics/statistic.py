"""Statistics of per-frame values that can be taken of any sample of the frames.

Every metric is a `Statistic`: values that belong to frames, and a reduction of them to one number
for each of many samples.  NaN marks a frame that has no value (a frame never shown has no lag).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .sample import Sample


@dataclass(frozen=True, slots=True, eq=False)
class Statistic:
    """Per-frame values and their reduction.

    Attributes
    ----------
    series : tuple of (n,) float64
        NaN where a frame has no value.
    reduce : callable
        From R samples and each series to (R,).
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
        value = float(self.of(Sample.whole(len(self.series[0])))[0])
        return value if np.isfinite(value) else None

    def of(self, sample: Sample) -> FloatArray:
        """Return the statistic of each sample, (R,); NaN where it has no value."""
        return self.reduce(sample, *self.series)


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


def _divide(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient: FloatArray = np.true_divide(numerator, denominator)
    quotient[denominator <= 0] = np.nan
    return quotient


def _mean(sample: Sample, x: FloatArray) -> FloatArray:
    known = ~np.isnan(x)
    if known.all():
        return _divide(sample.sums(x), sample.sums(known))
    return _divide(sample.sums(np.where(known, x, 0.0)), sample.sums(known))


def _sd(sample: Sample, x: FloatArray) -> FloatArray:
    # About the mean of all frames, which every sample's is near, so that little cancels.
    from_middle = x - np.nanmean(x)
    count = sample.sums(~np.isnan(x))
    shift = _mean(sample, from_middle)
    square = np.where(np.isnan(x), 0.0, from_middle * from_middle)
    return np.sqrt(_divide(np.maximum(sample.sums(square) - count * shift * shift, 0.0), count - 1))


def _quantile(
    sample: Sample, x: FloatArray, q: float, *, median_unbiased: bool = False
) -> FloatArray:
    """Quantile of type 7, or of type 8, which CapFrameX (by MathNet) takes."""
    values, drawn = sample.ordered(x)
    if not len(values):
        return np.full(len(drawn), np.nan)
    last = np.maximum(drawn[:, -1] - 1, 0)
    rank = q * last
    if median_unbiased:
        rank = np.clip((last + 4.0 / 3.0) * q - 2.0 / 3.0, 0.0, last)
    low, high = (_of_rank(values, drawn, whole) for whole in (np.floor(rank), np.ceil(rank)))
    result = low + (rank - np.floor(rank)) * (high - low)
    result[drawn[:, -1] == 0] = np.nan
    return result


def _of_rank(values: FloatArray, drawn: IntArray, rank: FloatArray) -> FloatArray:
    """Return the value of each sample's frame of a rank, counted from 0."""
    pairs = zip(drawn, rank, strict=True)
    at = [int(row.searchsorted(whole, side="right")) for row, whole in pairs]
    return values[np.minimum(at, len(values) - 1)]


def _fps_of_quantile(sample: Sample, x: FloatArray, q: float) -> FloatArray:
    return 1e3 / _quantile(sample, x, q)


def _ratio(sample: Sample, numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    return _divide(
        sample.sums(np.nan_to_num(numerator, nan=0.0)),
        sample.sums(np.nan_to_num(denominator, nan=0.0)),
    )


def _fps_low_mean(sample: Sample, x: FloatArray, share: float) -> FloatArray:
    values, drawn = sample.ordered(x)
    least = _quantile(sample, x, 1.0 - share, median_unbiased=True)
    fps = np.full(len(drawn), np.nan)
    for at, threshold in enumerate(map(float, least)):
        start = int(np.searchsorted(values, threshold))
        times: IntArray = np.diff(drawn[at], prepend=0)[start:]
        if len(times):
            fps[at] = 1e3 * times.sum() / float((times * values[start:]).sum())
    return fps


def _fps_low_integral(sample: Sample, x: FloatArray, share: float) -> FloatArray:
    values, drawn = sample.ordered(x)
    slowest_first = values[::-1]
    fps = np.full(len(drawn), np.nan)
    for at, row in enumerate(drawn):
        if not len(row) or not row[-1]:
            continue
        reached = np.cumsum(np.diff(row, prepend=0)[::-1] * slowest_first)
        fps[at] = 1e3 / slowest_first[np.argmax(reached >= share * reached[-1])]
    return fps
