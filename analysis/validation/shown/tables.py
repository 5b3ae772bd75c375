"""A validation as tables for a terminal."""

from typing import TYPE_CHECKING

from ..report.console_tables import titled_table
from ..report.values import ABSENT, format_span, format_value
from .time_errors import ErrorSummary
from .validation_result import Agreement, Errors, Validation

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console
    from rich.table import Table

COMPARED = {
    "model": "model of what was drawn",
    "v_time": "the same, adapted (v_time)",
    "simulation": "simulated replay",
    "again": "recorded again",
}
"""Fields of `Errors` and what tables call them."""

RANKED = ("frame_ms_mean", "frame_ms_sd", "over_budget_time_fraction")
"""Metrics whose values and ranks the short table shows."""


def errors_of(errors: Errors) -> list[ErrorSummary | None]:
    """Return errors in the order of `COMPARED`."""
    return [getattr(errors, name) for name in COMPARED]


def error_text(error: ErrorSummary | None) -> str:
    """Return mean and standard deviation as text, in per cent."""
    return ABSENT if error is None else f"{error.mean_pct:+.1f} ± {error.sd_pct:.1f}"


def rank_text(validation: Validation, metric: str, *, again: bool = False) -> str:
    """Return Kendall's τ of a metric as text, or of its second recording."""
    rank = validation.ranks.get(metric)
    tau = None if rank is None else rank.again if again else rank.simulated
    return ABSENT if tau is None else f"{tau:.2f}"


def print_validation(validation: Validation, console: "Console") -> None:
    """Print what was compared, errors of frame times, and metrics that matter most with ranks."""
    log = validation.log
    console.print(
        f"{validation.scene} along {validation.trace}, {validation.trace_s:.1f} s, budget "
        f"{validation.budget_ms:.4g} ms, on {log.get('renderer', 'a device')} at "
        f"{log.get('resolution', 'some size')}"
    )
    source = ", ".join(validation.measured_on) or validation.hardware_source
    console.print(f"hardware {validation.hardware}, calibrated on {source}")
    console.print(_error_table(validation))
    console.print(_metric_table(validation))
    if validation.inside is not None and validation.draws:
        console.print(
            f"{validation.inside:.0%} of all measured metrics lie in their {validation.level:.0%} "
            f"interval over {validation.draws} posterior draws"
        )


def _error_table(validation: Validation) -> "Table":
    title = "error of frame times, % of those measured, mean ± sd"
    table = titled_table(title, ("policy", *COMPARED.values()))
    for policy in validation.policies:
        table.add_row(policy.label, *map(error_text, errors_of(policy.errors)))
    table.add_section()
    table.add_row("all", *map(error_text, errors_of(validation.all_policies)))
    return table


def _metric_table(validation: Validation) -> "Table":
    title = "measured, and simulated with its interval; * outside"
    table = titled_table(title, ("policy", *RANKED))
    for policy in validation.policies:
        table.add_row(policy.label, *(_agreement(policy.metrics[name]) for name in RANKED))
    table.add_section()
    table.add_row("Kendall's τ", *(_ranks(validation, name) for name in RANKED))
    return table


def _agreement(item: Agreement) -> str:
    span = format_span(item.low, item.high) or f"{ABSENT} to {ABSENT}"
    outside = " *" if item.inside is False else ""
    return f"{format_value(item.measured)}{outside}\n{format_value(item.simulated)} ({span})"


def _ranks(validation: Validation, metric: str) -> str:
    if metric not in validation.ranks:
        return ABSENT
    return f"{rank_text(validation, metric)}, repeated {rank_text(validation, metric, again=True)}"
