"""A validation as tables for a terminal."""

from typing import TYPE_CHECKING

from ...report.console_tables import titled_table
from ...report.values import ABSENT, format_span, format_value
from ..answer import case_name
from ..validation_result import Agreement, Case, PolicyValidation, Validation
from .texts import (
    SHORT,
    SHOWN,
    decision_text,
    error_text,
    errors_of,
    judged_text,
    noise_text,
    rank_text,
    slope_text,
)

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console
    from rich.table import Table


def print_validation(validation: Validation, console: "Console") -> None:
    """Print what the numbers come to, then the tables of each case."""
    source = ", ".join(validation.measured_on) or validation.hardware_source
    console.print(f"hardware {validation.hardware}, calibrated on {source}")
    for sentence in validation.answer:
        console.print(sentence)
    for case in validation.cases:
        log = case.log
        console.print(
            f"\n{case_name(case)}, {case.trace_s:.1f} s, budget {case.budget_ms:.4g} ms, on "
            f"{log.get('renderer', 'a device')} at {log.get('resolution', 'some size')}"
        )
        if not case.policies:
            continue
        console.print(_error_table(case))
        console.print(_decision_table(case))
        console.print(_metric_table(case, validation))


def _error_table(case: Case) -> "Table":
    title = (
        "error of frame times, % of those measured, mean ± sd; noise of the machine alone (the "
        "model's sd in units of it); change of the error from no detail to all"
    )
    heads = ("policy", *SHORT, "noise", "detail")
    table = titled_table(title, heads)
    for policy in case.policies:
        table.add_row(policy.label, *_error_cells(policy))
    table.add_section()
    if case.all_policies is not None:
        every = case.all_policies
        table.add_row("all", *map(error_text, errors_of(every)), noise_text(every), "")
    if case.all_corrected is not None:
        every = case.all_corrected
        cells = (*map(error_text, errors_of(every)), noise_text(every), "")
        table.add_row("all, drift divided out", *cells)
    return table


def _error_cells(policy: PolicyValidation) -> tuple[str, ...]:
    errors = policy.errors
    return (*map(error_text, errors_of(errors)), noise_text(errors), slope_text(policy.detail))


def _decision_table(case: Case) -> "Table":
    title = "the verdict, simulated with its probability, and measured; ✗ not as measured"
    table = titled_table(title, ("policy", "p99, ms", "keeps the budget", "first or equal to it"))
    for policy in case.policies:
        cells = (decision_text(policy.keeps_budget), decision_text(policy.first))
        table.add_row(policy.label, judged_text(policy), *cells)
    return table


def _metric_table(case: Case, validation: Validation) -> "Table":
    title = (
        f"measured, and simulated with where {validation.level:.0%} of recordings of this path lie"
        "; * outside"
    )
    table = titled_table(title, ("policy", *SHOWN))
    for policy in case.policies:
        table.add_row(policy.label, *(_agreement(policy.metrics[name]) for name in SHOWN))
    table.add_section()
    table.add_row("Kendall's τ", *(rank_text(case.ranks.get(name)) for name in SHOWN))
    return table


def _agreement(item: Agreement) -> str:
    span = format_span(item.low, item.high) or f"{ABSENT} to {ABSENT}"
    outside = " *" if item.inside is False else ""
    return f"{format_value(item.measured)}{outside}\n{format_value(item.simulated)} ({span})"
