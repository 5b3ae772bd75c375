"""Which reported times a feedback policy may believe."""

import math

import numpy as np

from ..models.arrays import FloatArray
from .view import Completed

__all__ = ["Reports"]


class Reports:
    """Reads the work time of each completed frame once.

    A time that is missing, zero or negative is no time.  A timer that repeats its last report to
    the last digit may be stuck: such a report only counts where it speaks against detail, that is
    above the target, so that no fault ever raises detail.
    """

    __slots__ = ("_read",)

    def __init__(self) -> None:
        self._read = 0

    def new_ms(self, completed: Completed, target_ms: float) -> FloatArray:
        """Return the believable times that have arrived since the last call, oldest first."""
        first, self._read = self._read, len(completed)
        if self._read == first:
            return np.empty(0)
        times = completed.work_ms
        new = times[first:]
        before = np.concatenate(((times[first - 1] if first else math.nan,), new[:-1]))
        good = np.isfinite(new) & (new > 0.0) & ((new != before) | (new > target_ms))
        return new[good]

    def newest_ms(self, completed: Completed, target_ms: float) -> float:
        """Return the newest believable time since the last call, or NaN."""
        new = self.new_ms(completed, target_ms)
        return float(new[-1]) if len(new) else math.nan
