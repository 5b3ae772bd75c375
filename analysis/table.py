"""A comparison as tables for a terminal."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .comparison import Comparison, PolicyResult
from .metrics.registry import METRICS

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console
    from rich.table import Table

__all__ = ["ABSENT", "HEADLINE", "Column", "best_labels", "format_value", "print_comparison"]

ABSENT = "–"
BEST, ON_FRONT, BOUND = "*", "•", ">"


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
    console.print(describe_run(comparison), style="bold", soft_wrap=True)
    if comparison.ok:
        if wide:
            for table in _wide_tables(comparison, console.width):
                console.print("", table)
        else:
            console.print("", _short_table(comparison), "", sep="\n")
    for policy in comparison.policies:
        if policy.status != "ok":
            style = "bold red" if policy.status == "failed" else "yellow"
            console.print(
                f"{policy.status}: {policy.label}: {policy.reason}", style=style, soft_wrap=True
            )
    if comparison.ok:
        console.print(explain_marks(comparison), style="dim")


def describe_run(comparison: Comparison) -> str:
    """Return in one line what was replayed."""
    c = comparison.conditions
    hardware = comparison.hardware
    if c.hardware_assumed and "assumed" not in hardware:
        hardware += " (assumed)"
    parts = (
        f"{comparison.scene}, {c.nodes:,} nodes",
        f"{comparison.trace}, {c.trace_s:.1f} s",
        hardware,
        f"budget {comparison.budget_ms:.4g} ms",
        c.display if c.display in {"immediate", "vrr"} else f"{c.display} {c.refresh_hz:g} Hz",
        f"seed {comparison.seed}",
    )
    return " · ".join(parts)


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


def _short_table(comparison: Comparison) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, header_style="dim")
    table.add_column("policy", overflow="fold", min_width=12)
    for column in HEADLINE:
        table.add_column(column.header, justify="right", no_wrap=True)
    best = {column.metric: best_labels(comparison, column.metric) for column in HEADLINE}
    for policy in comparison.ok:
        cells = [Text(_name(policy, comparison))]
        for column in HEADLINE:
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
