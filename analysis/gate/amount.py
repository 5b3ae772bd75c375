"""Amounts as limits name them: a number in the metric's unit, a share, frames, or the budget."""

import math
import re
from dataclasses import dataclass
from typing import Literal

_SHARE = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*")
_FRAMES = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*frames?\s*")


@dataclass(frozen=True, slots=True)
class Amount:
    """An amount whose size depends on what it is measured in.

    Attributes
    ----------
    text : str
        As the user wrote it.
    measure : "unit", "share", "frames" or "budget"
        In the metric's unit, of the baseline's value, in refreshes of the display, or the budget.
    number : float
    """

    text: str
    measure: Literal["unit", "share", "frames", "budget"]
    number: float

    def resolve(self, budget_ms: float, refresh_hz: float) -> float:
        """Return the amount in the metric's unit; a share is of something else and stays one."""
        if self.measure == "frames":
            return self.number * 1e3 / refresh_hz
        return self.number * budget_ms if self.measure == "budget" else self.number

    def describe(self, budget_ms: float, refresh_hz: float) -> str:
        """Return the text, and beside a budget or frames what they are in milliseconds."""
        if self.measure in {"unit", "share"}:
            return self.text
        return f"{self.text} ({self.resolve(budget_ms, refresh_hz):.4g} ms)"


def parse_amount(value: object) -> Amount | None:
    """Return the amount that 16.7, "5%", "1 frame" or "budget" names, None for anything else."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return Amount(f"{value:g}", "unit", float(value)) if math.isfinite(value) else None
    if not isinstance(value, str):
        return None
    if value.strip() == "budget":
        return Amount("budget", "budget", 1.0)
    if share := _SHARE.fullmatch(value):
        return Amount(value.strip(), "share", float(share[1]) / 100.0)
    if frames := _FRAMES.fullmatch(value):
        return Amount(value.strip(), "frames", float(frames[1]))
    return None
