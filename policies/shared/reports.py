"""Which reported times a feedback policy may believe, and how far one moves what it steers."""

import math

import numpy as np

from ...base.arrays import FloatArray, IntArray


class Reports:
    """Reads the reported time of each completed frame once.

    A time that is missing, zero or negative is no time.  A timer that repeats its last report to
    the last digit may be stuck: such a report only counts where it speaks against detail, that is
    above the target, so that no fault ever raises detail.
    """

    def __init__(self) -> None:
        self._read = 0

    def new(self, times_ms: FloatArray, target_ms: float) -> tuple[IntArray, FloatArray]:
        """Return frames and times of the believable reports since the last call, oldest first.

        `times_ms` is a column of `Completed`: the reports of all frames so far.
        """
        first, self._read = self._read, len(times_ms)
        new = times_ms[first:]
        if not len(new):
            return np.empty(0, dtype=np.int32), new
        before = np.concatenate(((times_ms[first - 1] if first else math.nan,), new[:-1]))
        good = np.isfinite(new) & (new > 0.0) & ((new != before) | (new > target_ms))
        at = np.flatnonzero(good)
        return first + at, new[at]

    def newest_ms(self, times_ms: FloatArray, target_ms: float) -> float:
        """Return the newest believable time since the last call, or NaN."""
        _, new = self.new(times_ms, target_ms)
        return float(new[-1]) if len(new) else math.nan


def steer(value: float, ratio: float, gain: float, dead_band: float, rate_limit: float) -> float:
    """Return ``value · ratio^gain``, which changes it by at most the factor `rate_limit`.

    Within the dead band around 1, relative, and for NaN the value stays as it is.
    """
    if math.isnan(ratio) or abs(ratio - 1.0) <= dead_band:
        return value
    return value * float(np.clip(ratio**gain, 1.0 / rate_limit, rate_limit))
