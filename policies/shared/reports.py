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
        good = [at for at in range(first, self._read) if _believable(times_ms, at, target_ms)]
        frames = np.array(good, dtype=np.intp)
        return frames, times_ms[frames]

    def newest_ms(self, times_ms: FloatArray, target_ms: float) -> float:
        """Return the newest believable time since the last call, or NaN."""
        first, self._read = self._read, len(times_ms)
        # From the newest back: usually there is one new report, and it is good.
        for at in range(self._read - 1, first - 1, -1):
            if _believable(times_ms, at, target_ms):
                return float(times_ms[at])
        return math.nan


def steer(value: float, ratio: float, gain: float, dead_band: float, rate_limit: float) -> float:
    """Return ``value · ratio^gain``, which changes it by at most the factor `rate_limit`.

    Within the dead band around 1, relative, and for NaN the value stays as it is.
    """
    if math.isnan(ratio) or abs(ratio - 1.0) <= dead_band:
        return value
    return value * min(max(ratio**gain, 1.0 / rate_limit), rate_limit)


def _believable(times_ms: FloatArray, at: int, target_ms: float) -> bool:
    time_ms = float(times_ms[at])
    if not math.isfinite(time_ms) or time_ms <= 0.0:
        return False
    return time_ms > target_ms or at == 0 or time_ms != times_ms[at - 1]
