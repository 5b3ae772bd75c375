"""A validation as tables for a terminal."""

from typing import TYPE_CHECKING

from ..report.terminal_table import ABSENT, format_value
from .time_errors import ErrorSummary
from .validation_result import Errors, Validation

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console

COMPARED = (
    ("model", "model of what was drawn"),
    ("v_time", "the same, adapted (v_time)"),
    ("simulation", "simulated replay"),
    ("again", "recorded again"),
)
"""Fields of `Errors` and what tables call them."""

RANKED = ("frame_ms_mean", "frame_ms_sd", "over_budget_fraction")
"""Metrics whose values and ranks the short table shows."""


def error_word(errors: Errors, name: str) -> ErrorSummary | None:
    """Return errors by the name of their field."""
    return getattr(errors, name)


def error_text(found: ErrorSummary | None) -> str:
    """Return mean and standard deviation as text, in per cent."""
    return ABSENT if found is None else f"{found.mean_pct:+.1f} ± {found.sd_pct:.1f}"


def rank_text(tau: float | None) -> str:
    """Return a rank correlation as text."""
    return ABSENT if tau is None else f"{tau:.2f}"


def print_validation(validation: Validation, console: "Console") -> None:
    """Print what was compared, errors of frame times, and metrics that matter most with ranks."""
    from rich.table import Table

    log = validation.log
    console.print(
        f"{validation.scene} along {validation.trace}, {validation.trace_s:.1f} s, budget "
        f"{validation.budget_ms:.4g} ms, on {log.get('renderer', 'a device')} at "
        f"{log.get('resolution', 'some size')}"
    )
    source = ", ".join(validation.measured_on) or validation.hardware_source
    console.print(f"hardware {validation.hardware}, calibrated on {source}")
    errors = Table(title="error of frame times, % of those measured, mean ± sd")
    errors.add_column("policy", min_width=12)
    for _, title in COMPARED:
        errors.add_column(title, justify="right")
    for policy in validation.policies:
        row = (error_text(error_word(policy.errors, name)) for name, _ in COMPARED)
        errors.add_row(policy.label, *row)
    errors.add_section()
    row = (error_text(error_word(validation.all_policies, name)) for name, _ in COMPARED)
    errors.add_row("all", *row)
    console.print(errors)
    metrics = Table(title="measured, and simulated with its interval; * outside")
    metrics.add_column("policy", min_width=12)
    for name in RANKED:
        metrics.add_column(name, justify="right")
    for policy in validation.policies:
        cells: list[str] = []
        for name in RANKED:
            item = policy.metrics[name]
            span = f"{format_value(item.low)} to {format_value(item.high)}"
            out = " *" if item.inside is False else ""
            cells.append(
                f"{format_value(item.measured)}{out}\n{format_value(item.simulated)} ({span})"
            )
        metrics.add_row(policy.label, *cells)
    metrics.add_section()
    ranks = (validation.ranks.get(name) for name in RANKED)
    metrics.add_row(
        "Kendall's τ",
        *(
            ABSENT
            if rank is None
            else f"{rank_text(rank.simulated)}, repeated {rank_text(rank.again)}"
            for rank in ranks
        ),
    )
    console.print(metrics)
    if validation.inside is not None and validation.draws:
        console.print(
            f"{validation.inside:.0%} of all measured metrics lie in their {validation.level:.0%} "
            f"interval over {validation.draws} posterior draws"
        )
