"""The newest measured time that is worth acting on."""

import math
from dataclasses import dataclass

from ..models.arrays import FloatArray

__all__ = ["FreshTimes"]


@dataclass(slots=True)
class FreshTimes:
    """Remembers which report was read last, so that a policy acts on each report once.

    A report that is missing, zero, negative or exactly the one before says nothing: timers that
    lose a frame or stall report so, and acting on it would raise detail after a lag.
    """

    _seen: int = 0
    _last_ms: float = math.nan

    def newest(self, times_ms: FloatArray) -> tuple[int, float] | None:
        """Return frame and time of the newest of the reports (one a frame), None if nothing new."""
        if len(times_ms) == self._seen:
            return None
        self._seen = len(times_ms)
        time_ms = float(times_ms[-1])
        if not (math.isfinite(time_ms) and time_ms > 0.0) or time_ms == self._last_ms:
            return None
        self._last_ms = time_ms
        return self._seen - 1, time_ms
