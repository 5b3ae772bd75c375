"""Faulty measurements on purpose: what a policy is told, not what happened.

Users report timers that lose a frame, read zero after a stall, repeat an old value, or saturate
(a stalled frame reported as about 0 ms made a controller raise quality right after a lag spike).
"""

import math
from dataclasses import dataclass, fields

from ...base.errors import InputError

Report = tuple[float, float, float]
"""CPU, GPU and work milliseconds of one frame."""


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

    def report(self, times_ms: Report, before: Report, dice: float) -> Report:
        """Return what timers say of one frame; `dice` is uniform in [0, 1)."""
        if dice < self.missing:
            return (math.nan, math.nan, math.nan)
        if dice < self.missing + self.zero:
            return (0.0, 0.0, 0.0)
        if dice < self.missing + self.zero + self.stale:
            return before
        cpu_ms, gpu_ms, work_ms = times_ms
        limit_ms = self.saturated_ms
        return (min(cpu_ms, limit_ms), min(gpu_ms, limit_ms), min(work_ms, limit_ms))


def parse_faults(text: str) -> Faults:
    """Return the faults that ``kind=number,kind=number`` names; none for an empty text.

    Raises `InputError` if a kind is unknown or a number is none, or out of range.
    """
    kinds = [field.name for field in fields(Faults)]
    numbers: dict[str, float] = {}
    for item in filter(None, text.split(",")):
        kind, _, number = item.partition("=")
        try:
            numbers[kind] = float(number)
        except ValueError:
            kind = ""
        if kind not in kinds:
            raise InputError(
                f"faults: expected KIND=NUMBER with a kind of {', '.join(kinds)}, got {item}"
            )
    return Faults(**numbers)
