"""Numbers of a validation in words, the same in tables for a terminal and on the page."""

from ...report.values import ABSENT, format_value
from ..validation_result import Decision, DetailError, Errors, ErrorSummary, PolicyValidation, Rank

COMPARED = {
    "model": "model of what was drawn",
    "v_time": "the same, adapted (v_time)",
    "simulation": "simulated replay",
    "again": "recorded again",
    "repeat": "again, for what was drawn",
}
"""Fields of `Errors` and what tables call them."""

SHORT = ("model", "v_time", "simulated", "again", "for what was drawn")
"""The same where there is little room."""

SHOWN = ("frame_ms_mean", "frame_ms_sd", "over_budget_time_fraction", "toggles_per_s")
"""Metrics whose values and ranks short tables and charts show."""


def errors_of(errors: Errors) -> list[ErrorSummary | None]:
    """Return errors in the order of `COMPARED`."""
    return [getattr(errors, name) for name in COMPARED]


def error_text(error: ErrorSummary | None) -> str:
    """Return mean and standard deviation as text, in per cent."""
    return ABSENT if error is None else f"{error.mean_pct:+.1f} ± {error.sd_pct:.1f}"


def noise_text(errors: Errors) -> str:
    """Return the machine's own scatter in per cent, and the model's in units of it."""
    if errors.noise_pct is None or errors.excess is None:
        return ABSENT
    return f"{errors.noise_pct:.1f} (× {errors.excess:.2f})"


def slope_text(detail: DetailError | None) -> str:
    """Return how the error goes with the level of detail."""
    return ABSENT if detail is None or detail.slope_pct is None else f"{detail.slope_pct:+.0f}"


def rank_text(rank: Rank | None) -> str:
    """Return τ with its interval, and over how many pairs."""
    if rank is None or rank.simulated is None:
        return ABSENT
    return f"{rank.simulated:.2f} ({rank.low:.2f} to {rank.high:.2f}), {rank.apart} of {rank.pairs}"


def decision_text(decision: Decision) -> str:
    """Return what was decided, how surely, and what was measured."""
    measured = {True: "yes", False: "no", None: "open"}[decision.measured]
    mark = " ✗" if decision.as_measured is False else ""
    return f"{decision.decided} ({decision.probability:.0%}), measured {measured}{mark}"


def judged_text(policy: PolicyValidation) -> str:
    """Return the measured times by which the budget is judged."""
    return " and ".join(format_value(ms) for ms in policy.judged_ms)
