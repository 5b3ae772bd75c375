"""A comparison as sentences and tables for a terminal: the answer first."""

from typing import TYPE_CHECKING

from ..metrics.metric_registry import METRICS
from ..study.comparison import Comparison
from ..study.comparison_parts import PolicyResult
from .console_tables import plain_table
from .names import short_name
from .summary import (
    HEADLINE,
    MetricColumn,
    behind_text,
    describe_run,
    folded,
    keeps_text,
    knob_words,
    rank_text,
    shown_policies,
    unscored,
    words_of,
)
from .values import counted, format_value

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from collections.abc import Iterator

    from rich.console import Console
    from rich.table import Table

_LABEL_WIDTH, _KNOB_WIDTH = 20, 22
"""Longer texts are folded, unless the terminal has more room than `_NUMBERS_WIDTH` for numbers."""
_NUMBERS_WIDTH = 80
_UNIT_WIDTH, _VALUE_WIDTH = 44, 26
"""Of the wide table: what metric and unit take, and each policy."""


def print_comparison(comparison: Comparison, console: "Console", *, wide: bool) -> None:
    """Print the answer, what was run, its table, and what the numbers mean."""
    for place, sentence in enumerate(comparison.answer):
        style = "bold" if place == 0 else None
        console.print(words_of(comparison, sentence), style=style, markup=False)
    console.print()
    console.print(words_of(comparison, describe_run(comparison)), style="dim", markup=False)
    for warning in comparison.warnings:
        console.print(f"warning: {warning}", style="yellow", markup=False)
    if comparison.ok and wide:
        for table in _wide_tables(comparison, console.width):
            console.print("", table)
    elif comparison.ok:
        for table in _short_tables(comparison, console):
            console.print("", table)
        console.print()
    for sentence in folded(comparison):
        console.print(words_of(comparison, sentence), style="dim", markup=False)
    for status, reason in unscored(comparison):
        style = "bold red" if status == "failed" else "yellow"
        text = words_of(comparison, reason)
        console.print(text, style=style, soft_wrap=True, markup=False)
    if comparison.ok:
        console.print(explain(comparison, " (--wide)"), style="dim", markup=False)


def explain(comparison: Comparison, shown_by: str = "") -> str:
    """Return what ranks, probabilities and intervals mean; `shown_by` says how to see the last."""
    s = comparison.sampling
    draws = f", {counted(s.draws, 'draw')} of the machine" if s.draws else ""
    return (
        f"keeps: probability that work time is within the budget for {1.0 - comparison.miss:.0%} "
        f"of the time on {comparison.population}, and how many of the judged paths were kept; "
        f"{s.tuned_on}.\n"
        "Ranks are of those that keep it with .9 or more, by visible error (beyond "
        f"{comparison.visible:g} px), then visible pops, then lag, then work; within the margin of "
        f"{comparison.margin:.0%} they share the rank; beside it: what told it from those "
        "before.\n"
        f"Intervals{shown_by}: {s.level:.0%}, {comparison.population}; "
        f"{counted(s.seeds, 'seed')} a path{draws}."
    )


def _short_tables(comparison: Comparison, console: "Console") -> "Iterator[Table]":
    """Return the headline, as many of its columns beside each other as fit.

    Knob and gate stand in the first table alone, so that a narrow terminal gets few.
    """
    label_width = max(_LABEL_WIDTH, console.width - _NUMBERS_WIDTH)
    unbounded = console.options.update(max_width=1000)
    left = HEADLINE
    while left:
        first = left is HEADLINE
        tables = [
            _short_table(comparison, left[:count], label_width, gate=first)
            for count in range(len(left), 0, -1)
        ]
        widths = (console.measure(table, options=unbounded).maximum for table in tables)
        skip = next((i for i, width in enumerate(widths) if width <= console.width), -1)
        shown = tables[skip]
        yield shown
        left = left[len(shown.columns) - (4 if first else 2) :]


def _short_table(
    comparison: Comparison,
    columns: tuple[MetricColumn, ...],
    label_width: int,
    *,
    gate: bool,
) -> "Table":
    from rich.text import Text

    table = plain_table()
    table.add_column("rank", no_wrap=True)
    table.add_column("policy", overflow="fold", max_width=label_width)
    if gate:
        table.add_column("knob", overflow="fold", max_width=_KNOB_WIDTH)
        table.add_column("keeps", no_wrap=True, justify="right")
    for column in columns:
        table.add_column(column.header, justify="right", no_wrap=True)
    before: str | None = None
    for policy in shown_policies(comparison):
        rank = rank_text(policy)
        if before is not None and rank != before:
            table.add_section()
        before = rank
        style = "bold green" if rank == "1" else ""
        cells = (column.text(policy) for column in columns)
        names = (f"{rank} {behind_text(policy)}".rstrip(), Text(short_name(policy.label)))
        kept = (Text(knob_words(policy)), keeps_text(policy)) if gate else ()
        table.add_row(*names, *kept, *cells, style=style)
    return table


def _wide_tables(comparison: Comparison, width: int) -> "list[Table]":
    """Return every metric with its interval, as many policies beside each other as fit."""
    fit = max(1, (width - _UNIT_WIDTH) // _VALUE_WIDTH)
    shown = shown_policies(comparison)
    return [_wide_table(shown[i : i + fit]) for i in range(0, len(shown), fit)]


def _wide_table(policies: tuple[PolicyResult, ...]) -> "Table":
    from rich.text import Text

    table = plain_table()
    table.add_column("metric", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for policy in policies:
        table.add_column(Text(short_name(policy.label)), overflow="fold", justify="right")
    group = METRICS[0].group
    for metric in METRICS:
        if metric.group != group:
            table.add_section()
            group = metric.group
        table.add_row(
            metric.id, metric.unit, *(_interval(policy, metric.id) for policy in policies)
        )
    return table


def _interval(policy: PolicyResult, metric: str) -> str:
    """Return a value with its interval: over such paths, else of this path."""
    score = policy.metrics[metric]
    span = score.such_paths or score.this_path
    if span is None:
        return format_value(score.value)
    text = f"({format_value(span[0])}, {format_value(span[1])})"
    doubtful = score.such_paths is not None and not score.enough
    return f"{format_value(score.value)} {text:>16}{'?' if doubtful else ''}"
