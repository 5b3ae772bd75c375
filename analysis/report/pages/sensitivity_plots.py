"""Shares of variance as bars over their intervals, one plot a metric."""

from ...study.sensitivity import Share
from ...study.sweep.sensitivities import NOISE, TOGETHER, Sensitivities, Sensitivity
from ...study.sweep.show_tables import sensitivity_rows
from ..blocks import Block, Paragraph, Table
from ..palette import Ink
from ..plots import HIGH, WIDE, Axis, Line, Mark, Plot, Plots, Row
from ..values import counted, format_value

_INK = Ink("", "solid", "circle", 0)  # no policy's: no click hides it
_X = Axis("share of the variance", 0.0, 1.0)
_LEAST = WIDE // 200
"""Width of an interval that is too narrow to be seen."""


def sensitivity_blocks(found: Sensitivities) -> tuple[Block, ...]:
    """Return a plot for each metric that varies, the same as a table, and what was left out."""
    plots = [_plot(f"shares-{at}", item) for at, item in enumerate(found.metrics) if item.shares]
    table = sensitivity_rows(found)
    words = f"The same in numbers, of {counted(found.runs, 'run')}"
    rows = [tuple(row) for row in table.shown()]
    return (
        Plots(plots, beside=True),
        Table(table.header, rows, "facts", folded=words),
        *(Paragraph(note, "dim") for note in found.notes),
    )


def largest_share(item: Sensitivity) -> tuple[str, Share]:
    """Return what explains most of a metric's variance, in words, and its share."""
    name, share = max(item.shares.items(), key=lambda pair: pair[1].value)
    return {TOGETHER: "axes together", NOISE: "the noise of seeds"}.get(name, name), share


def share_text(share: Share) -> str:
    """Return a share with its interval, where it has one."""
    if share.low is None or share.high is None:
        return format_value(share.value)
    return f"{format_value(share.value)} ({format_value(share.low)} to {format_value(share.high)})"


def _plot(chart: str, item: Sensitivity) -> Plot:
    rows: list[Row] = []
    marks: list[Mark] = []
    step = 100.0 / len(item.shares)
    for at, (axis, share) in enumerate(item.shares.items()):
        text = f"{axis}: {share_text(share)}"
        bars = [] if share.low is None or share.high is None else [_bar(share.low, share.high)]
        rows.append(Row(_INK, f"{max(share.value, 0.0):.2f} {axis}", bars, text))
        left, below = round(100.0 * _X.at(share.value), 2), round(100.0 - step * (at + 0.5), 2)
        marks.append(Mark(_INK, left, below, text))
    most, share = largest_share(item)
    caption = f"{most} explains most: {share_text(share)}."
    return Plot(chart, item.metric, _X, Axis("", 0.0, 0.0), marks=marks, rows=rows, caption=caption)


def _bar(low: float, high: float) -> Line:
    left, right = (round(WIDE * _X.at(end)) for end in (low, high))
    return Line(_INK, f"M{left} {HIGH // 2}H{max(right, left + _LEAST)}", "band", "90 % interval")
