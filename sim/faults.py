"""Faulty measurements on purpose: what a policy is told, not what happened.

Users report timers that lose a frame, read zero after a stall, repeat an old value, or saturate
(a stalled frame reported as about 0 ms made a controller raise quality right after a lag spike).
"""

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..models.arrays import FloatArray

__all__ = ["Faults"]


@dataclass(frozen=True, slots=True)
class Faults:
    """Share of frames whose measurement is faulty, by kind; at most one kind a frame.

    Attributes
    ----------
    missing : reported as NaN
    zero : reported as 0 ms
    stale : the report of the frame before is repeated
    saturated_ms : reports never exceed this
    """

    missing: float = 0.0
    zero: float = 0.0
    stale: float = 0.0
    saturated_ms: float = float("inf")

    def __post_init__(self) -> None:
        shares = (self.missing, self.zero, self.stale)
        if not all(0.0 <= share <= 1.0 for share in shares) or sum(shares) > 1.0:
            raise InputError(f"faults: expected shares in [0, 1] with sum <= 1, got {shares}")
        if not self.saturated_ms > 0.0:
            raise InputError(f"faults: expected saturated_ms > 0, got {self.saturated_ms}")

    def report(self, times_ms: FloatArray, before: FloatArray, dice: float) -> FloatArray:
        """Return what a timer says of one frame's times; `dice` is uniform in [0, 1)."""
        if dice < self.missing:
            return np.full_like(times_ms, np.nan)
        if dice < self.missing + self.zero:
            return np.zeros_like(times_ms)
        if dice < self.missing + self.zero + self.stale:
            return before
        return np.minimum(times_ms, self.saturated_ms)
