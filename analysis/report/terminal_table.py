"""A comparison as tables for a terminal."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..metrics.metric_registry import METRICS
from ..study.comparison import Comparison, PolicyResult, Status

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from collections.abc import Iterator

    from rich.console import Console
    from rich.table import Table

ABSENT = "–"
BEST, ON_FRONT, BOUND = "*", "•", ">"
_LABEL_WIDTH = 20
"""Longer labels are folded, unless the terminal has more room than `_NUMBERS_WIDTH` for numbers."""
_NUMBERS_WIDTH = 80


@dataclass(frozen=True, slots=True)
class Column:
    """A metric as a column of the short table."""

    metric: str
    header: str
    percent: bool = False


HEADLINE = (
    Column("work_ms_p95", "work\np95\nms"),
    Column("frame_ms_sd", "frame\nsd\nms"),
    Column("over_budget_fraction", "over\nbudget\n%", percent=True),
    Column("settle_ms", "settle\n\nms"),
    Column("overshoot_ratio", "over-\nshoot\n×"),
    Column("lag_ms_mean", "lag\nmean\nms"),
    Column("toggles_per_frame", "toggle\n/frame"),
    Column("popping_px_per_frame", "pop px\n/frame"),
    Column("sse_px_p95", "error\np95\npx"),
    Column("benefit_ratio", "bene-\nfit\n%", percent=True),
)


def format_value(value: float | None, *, percent: bool = False) -> str:
    """Return three significant digits, or a dash for what a run cannot have."""
    if value is None:
        return ABSENT
    if percent:
        value *= 100.0
    size = abs(value)
    if size == 0.0:
        return "0"
    if size >= 99.95:
        return f"{value:,.0f}"
    if size < 0.0005:
        return f"{value:.0e}".replace("e-0", "e-")
    return f"{value:.{1 if size >= 9.995 else 2 if size >= 0.9995 else 3}f}"


def best_labels(comparison: Comparison, metric: str) -> set[str]:
    """Return the policies with the best value; none where all are equal, and never an oracle."""
    scores = {policy.label: policy.metrics[metric] for policy in comparison.ok if not policy.oracle}
    values = {label: item.value for label, item in scores.items() if item.value is not None}
    if len(set(values.values())) < 2:
        return set()
    pick = min if next(iter(scores.values())).better == "lower" else max
    best = pick(values.values())
    return {label for label, value in values.items() if value == best}


def print_comparison(comparison: Comparison, console: "Console", *, wide: bool) -> None:
    """Print the run in one line, its table, and what the marks mean."""
    console.print(describe_run(comparison), style="bold")
    if comparison.ok:
        if wide:
            for table in _wide_tables(comparison, console.width):
                console.print("", table)
        else:
            for table in _short_tables(comparison, console):
                console.print("", table)
            console.print()
    for status, labels, reason in unscored(comparison):
        style = "bold red" if status == "failed" else "yellow"
        console.print(f"{status}: {', '.join(labels)}: {reason}", style=style, soft_wrap=True)
    if comparison.ok:
        console.print(explain_marks(comparison), style="dim")


def unscored(comparison: Comparison) -> list[tuple[Status, list[str], str]]:
    """Return status, labels and reason of what has no scores, one entry for each reason."""
    groups: dict[tuple[Status, str], list[str]] = {}
    for policy in comparison.policies:
        if policy.status != "ok":
            groups.setdefault((policy.status, policy.reason or ""), []).append(policy.label)
    return [(status, labels, reason) for (status, reason), labels in groups.items()]


def describe_run(comparison: Comparison) -> str:
    """Return in one line what was replayed."""
    c = comparison.conditions
    hardware = comparison.hardware
    if c.hardware_assumed and "assumed" not in hardware:
        hardware += " (assumed)"
    parts = (
        f"{comparison.scene}, {c.nodes:,} nodes",
        f"{comparison.trace}, {c.trace_s:.1f} s{_frames(comparison)}",
        hardware,
        f"budget {comparison.budget_ms:.4g} ms",
        c.display if c.display in {"immediate", "vrr"} else f"{c.display} {c.refresh_hz:g} Hz",
        f"seed {comparison.seed}",
    )
    return " · ".join(parts)


def _frames(comparison: Comparison) -> str:
    counts = {policy.frames for policy in comparison.ok}
    if not counts:
        return ""
    return f", {'up to ' if len(counts) > 1 else ''}{max(counts):,} frames"


def explain_marks(comparison: Comparison) -> str:
    """Return what marks and intervals mean, and what is left out."""
    i = comparison.intervals
    pooled = f", pooled over {i.draws} draws of the cost model" if i.draws else ""
    return (
        f"{BEST} best of its column   {ON_FRONT} on the Pareto front of budget, lag, toggles, error"
        f"   {BOUND} lower bound\n"
        f"The first {comparison.warmup} frames are warm-up and not counted.\n"
        f"Intervals (--wide): {i.level:.0%}, blocks of 1/{i.blocks} of the run{pooled}."
    )


def _name(policy: PolicyResult, comparison: Comparison) -> str:
    mark = ON_FRONT if policy.label in comparison.pareto.front else " "
    return f"{mark} {policy.label}{' (oracle)' if policy.oracle else ''}"


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


def _short_table(comparison: Comparison, columns: tuple[Column, ...], label_width: int) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, header_style="dim")
    table.add_column("policy", overflow="fold", max_width=label_width)
    for column in columns:
        table.add_column(column.header, justify="right", no_wrap=True)
    best = {column.metric: best_labels(comparison, column.metric) for column in columns}
    for policy in comparison.ok:
        cells = [Text(_name(policy, comparison))]
        for column in columns:
            metric = column.metric
            text = format_value(policy.metrics[metric].value, percent=column.percent)
            if metric == "settle_ms" and not all(step.settled for step in policy.steps):
                text = BOUND + text
            wins = policy.label in best[metric]
            cells.append(Text(text + (BEST if wins else " "), style="bold green" if wins else ""))
        table.add_row(*cells)
    return table


def _wide_tables(comparison: Comparison, width: int) -> "list[Table]":
    """Return every metric with its interval, as many policies beside each other as fit."""
    fit = max(1, (width - 44) // 26)
    ok = comparison.ok
    return [_wide_table(comparison, ok[i : i + fit]) for i in range(0, len(ok), fit)]


def _wide_table(comparison: Comparison, policies: tuple[PolicyResult, ...]) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, header_style="dim")
    table.add_column("metric", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for policy in policies:
        table.add_column(_name(policy, comparison), overflow="fold", justify="right")
    group = METRICS[0].group
    for metric in METRICS:
        if metric.group != group:
            table.add_section()
            group = metric.group
        best = best_labels(comparison, metric.id)
        cells = [Text(metric.id), Text(metric.unit)]
        for policy in policies:
            score = policy.metrics[metric.id]
            wins = policy.label in best
            text = format_value(score.value) + (BEST if wins else " ")
            span = f"[{format_value(score.low)}, {format_value(score.high)}]"
            if score.low is not None:
                text += f" {span:>16}"
            cells.append(Text(text, style="bold green" if wins else ""))
        table.add_row(*cells)
    return table
