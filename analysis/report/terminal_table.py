"""A comparison as tables for a terminal."""

from typing import TYPE_CHECKING

from ..metrics.metric_registry import METRICS
from ..study.comparison import Comparison, PolicyResult
from .console_tables import plain_table
from .summary import BOUND, HEADLINE, MetricColumn, best_labels, describe_run, unscored
from .values import format_value

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from collections.abc import Iterator

    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

BEST = "*"
_LABEL_WIDTH = 20
"""Longer labels are folded, unless the terminal has more room than `_NUMBERS_WIDTH` for numbers."""
_NUMBERS_WIDTH = 80
_UNIT_WIDTH, _VALUE_WIDTH = 44, 26
"""Of the wide table: what metric and unit take, and each policy."""


def print_comparison(comparison: Comparison, console: "Console", *, wide: bool) -> None:
    """Print the run in one line, its table, and what the marks mean."""
    console.print(describe_run(comparison), style="bold")
    if comparison.ok and wide:
        for table in _wide_tables(comparison, console.width):
            console.print("", table)
    elif comparison.ok:
        for table in _short_tables(comparison, console):
            console.print("", table)
        console.print()
    for status, reason in unscored(comparison):
        style = "bold red" if status == "failed" else "yellow"
        console.print(reason, style=style, soft_wrap=True)
    if comparison.ok:
        console.print(explain_marks(comparison), style="dim")


def explain_marks(comparison: Comparison) -> str:
    """Return what marks and intervals mean, and what is left out."""
    i, (start_s, end_s) = comparison.intervals, comparison.window_s
    marks = (
        f"{BEST} best of its column   {BOUND} lower bound\n"
        f"Scored over {start_s:g} to {end_s:g} s of the path, by its clock."
    )
    if not i.draws:
        return marks
    return f"{marks}\nIntervals (--wide): {i.level:.0%} of {i.draws} draws of the cost model."


def _name(policy: PolicyResult) -> str:
    return f"{policy.label}{' (oracle)' if policy.oracle else ''}"


def _short_tables(comparison: Comparison, console: "Console") -> "Iterator[Table]":
    """Return the headline, as many of its columns beside each other as fit."""
    label_width = max(_LABEL_WIDTH, console.width - _NUMBERS_WIDTH)
    unbounded = console.options.update(max_width=1000)
    left = HEADLINE
    while left:
        tables = [
            _short_table(comparison, left[:count], label_width) for count in range(len(left), 0, -1)
        ]
        widths = (console.measure(table, options=unbounded).maximum for table in tables)
        skip = next((i for i, width in enumerate(widths) if width <= console.width), -1)
        yield tables[skip]
        left = left[len(tables[skip].columns) - 1 :]


def _short_table(
    comparison: Comparison, columns: tuple[MetricColumn, ...], label_width: int
) -> "Table":
    from rich.text import Text

    table = plain_table()
    table.add_column("policy", overflow="fold", max_width=label_width)
    for column in columns:
        table.add_column(column.header, justify="right", no_wrap=True)
    best = [best_labels(comparison, column.metric) for column in columns]
    for policy in comparison.ok:
        cells = (
            _marked(column.text(policy), best=policy.label in labels)
            for column, labels in zip(columns, best, strict=True)
        )
        table.add_row(Text(_name(policy)), *cells)
    return table


def _wide_tables(comparison: Comparison, width: int) -> "list[Table]":
    """Return every metric with its interval, as many policies beside each other as fit."""
    fit = max(1, (width - _UNIT_WIDTH) // _VALUE_WIDTH)
    ok = comparison.ok
    return [_wide_table(comparison, ok[i : i + fit]) for i in range(0, len(ok), fit)]


def _wide_table(comparison: Comparison, policies: tuple[PolicyResult, ...]) -> "Table":
    table = plain_table()
    table.add_column("metric", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for policy in policies:
        table.add_column(_name(policy), overflow="fold", justify="right")
    group = METRICS[0].group
    for metric in METRICS:
        if metric.group != group:
            table.add_section()
            group = metric.group
        best = best_labels(comparison, metric.id)
        cells: list[Text] = []
        for policy in policies:
            score = policy.metrics[metric.id]
            span = f"[{format_value(score.low)}, {format_value(score.high)}]"
            after = "" if score.low is None else f" {span:>16}"
            cells.append(_marked(format_value(score.value), after, best=policy.label in best))
        table.add_row(metric.id, metric.unit, *cells)
    return table


def _marked(value: str, after: str = "", *, best: bool) -> "Text":
    """Return a value with its mark, and room for one where it has none, so that digits align."""
    from rich.text import Text

    return Text(f"{value}{BEST if best else ' '}{after}", "bold green" if best else "")
