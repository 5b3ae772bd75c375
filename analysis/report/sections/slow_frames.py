"""For how much of the time frames take how long: work time, and interval between displays."""

from collections.abc import Iterator

import numpy as np

from ....base.arrays import FloatArray
from ...metrics.measured_frames import MeasuredFrames
from ...metrics.over_time import time_quantile
from ..blocks import Paragraph
from ..plots import Axis, Line, Plot, Plots, Rule, line_of
from ..results import Results, section
from ..series import stairs, tail
from ..values import format_value

_POINTS = 250
_LEAST_PCT = 0.1
_LEAST, _MOST = 0.05, 5.0
"""Times that are drawn, in budgets."""


def _in_short(results: Results) -> str:
    share = 1.0 - results.comparison.miss
    runs = {p.label: results.first_path(p.label) for p in results.drawn}
    found = {at: time_quantile(run.work_ms, run.cost_weight_ms, share) for at, run in runs.items()}
    known = {label: work_ms for label, work_ms in found.items() if work_ms is not None}
    first = results.first.label
    if first not in known:
        return ""
    text = f"For {100.0 * share:g} % of the time {first} works {format_value(known[first])} ms a "
    text += "frame or less"
    slowest = max(known, key=known.__getitem__)
    if known[slowest] == known[first]:
        return f"{text} on this path, and nobody longer."
    return f"{text} on this path; {slowest}, the slowest, {format_value(known[slowest])} ms."


@section("How slow the slow frames are", takeaway=_in_short)
def slow_frames(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """On the first path, the share of time in frames that take so long or longer; both logarithmic.

    The 99th percentile is where a line crosses 1 %.
    """
    if not results.drawn:
        return (Paragraph("Nothing to draw in this run.", "dim"),)
    return (Plots(list(_plots(results)), beside=True),)


def _plots(results: Results) -> Iterator[Plot]:
    window = results.comparison.window_s[0]
    runs = {p.label: MeasuredFrames(results.logs[p.label], *window) for p in results.drawn}
    for name, title, values in (
        ("work-tail", "Work time", {at: run.work_ms for at, run in runs.items()}),
        ("frame-tail", "Interval between displays", {at: run.frame_ms for at, run in runs.items()}),
    ):
        shares = {at: tail(values[at], run.cost_weight_ms, _POINTS) for at, run in runs.items()}
        yield _plot(results, name, title, shares)


def _plot(
    results: Results, name: str, title: str, shares: dict[str, tuple[FloatArray, FloatArray]]
) -> Plot:
    budget = results.comparison.budget_ms
    ends = np.concatenate([x for x, _ in shares.values()] + [np.array([budget])])
    ends = ends[ends > 0.0]
    high = min(max(1.1 * float(ends.max()), 1.5 * budget), _MOST * budget)
    x = Axis("ms", max(0.8 * float(ends.min()), _LEAST * budget), high, "log")
    y = Axis("time in frames at least this slow, %", _LEAST_PCT, 100.0, "log")
    lines: list[Line] = []
    for label, (value_ms, share) in shares.items():
        lines.append(line_of(results.inks[label], (x, y), stairs(value_ms, 100.0 * share)))
    rule = Rule(True, round(100.0 * x.at(budget), 2), f"budget {budget:.4g} ms")
    return Plot(
        name, f"{title}: % of time in frames at least this slow", x, y, lines, rules=[rule],
        height_px=280,
    )  # fmt: skip
