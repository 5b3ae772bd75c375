"""Small multiples of a study: the mean of a metric over an axis, a line or points by policy."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...metrics.metric_registry import find_metric
from ...study.axes.grid import Cell
from ...study.sweep.query import Group, Query
from ..names import short_name
from ..palette import Ink
from ..plots import Axis, Line, Mark, Plot, line_of
from ..values import counted, format_value

_NOT_DRAWN = ("policy", "seed", "draw")
"""What the legend rules, and what is noise."""
_LOG_FROM = 20.0
"""Ratio of the ends of an axis from which on it is logarithmic."""
_LETTERS = 36
"""Of all names along an axis, for which there is room."""
_SPREAD = 0.5
"""Width over which policies stand beside each other at a name, in steps of the axis."""
_HEIGHT_PX = 150


@dataclass(frozen=True, slots=True)
class _Point:
    """The mean of a metric at a cell of an axis."""

    cell: Cell
    x: float
    mean: float
    runs: int


def axis_plots(query: Query, metrics: Sequence[str], inked: dict[str, Ink]) -> list[list[Plot]]:
    """Return for each metric a plot for each axis that has two values or more.

    Axes of numbers have lines; others, and those on which a policy has also runs without a value,
    have points at names, where policies stand beside each other.
    """
    axes = [
        name
        for name in query.results.axes
        if name not in _NOT_DRAWN and len(query.rows([name]).column(0).unique().drop_null()) > 1
    ]
    groups = {name: query.groups(["policy", name], metrics) for name in axes}
    return [
        [
            _axis_plot(f"multiple-{row}-{column}", metric, row, name, groups[name], inked)
            for column, name in enumerate(axes)
        ]
        for row, metric in enumerate(metrics)
    ]


def cell_text(cell: Cell) -> str:
    """Return a value of an axis as a name."""
    if cell is None:
        return "none"
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)


def _axis_plot(
    chart: str, metric: str, at: int, name: str, groups: Sequence[Group], inked: dict[str, Ink]
) -> Plot:
    unit = find_metric(metric).unit
    cells = list(dict.fromkeys(group.cells[1] for group in groups))
    numbers = _are_numbers(groups)
    points = _points(groups, at, cells, inked, numbers=numbers)
    means = [point.mean for some in points.values() for point in some]
    x = _axis_of_numbers(name, cells) if numbers else _axis_of_names(name, cells)
    y = Axis(f"{metric}, {unit}", min(0.0, 1.1 * min(means, default=0.0)), _top(means))
    lines: list[Line] = []
    marks: list[Mark] = []
    for label, some in points.items():
        if numbers:
            xs, ys = (np.array([getattr(point, of) for point in some]) for of in ("x", "mean"))
            lines.append(line_of(inked[label], (x, y), (xs, ys)))
        for point in some:
            words = (
                f"{short_name(label)}: {name} {short_name(cell_text(point.cell))}; {y.title} "
                f"{format_value(point.mean)}, mean of {counted(point.runs, 'run')}"
            )
            left, below = (
                round(100.0 * axis.at(value), 3) for axis, value in ((x, point.x), (y, point.mean))
            )
            marks.append(Mark(inked[label], left, below, words))
    return Plot(
        chart, f"{metric} over {name}, {unit}", x, y, lines, marks, height_px=_HEIGHT_PX,
        caption=_caption(points),
    )  # fmt: skip


def _are_numbers(groups: Sequence[Group]) -> bool:
    """Whether cells are numbers, none of which a policy has beside runs without a value."""
    known = [group.cells[1] for group in groups if group.cells[1] is not None]
    if not all(isinstance(cell, int | float) and not isinstance(cell, bool) for cell in known):
        return False
    without = {group.cells[0] for group in groups if group.cells[1] is None}
    return not without & {group.cells[0] for group in groups if group.cells[1] is not None}


def _points(
    groups: Sequence[Group], at: int, cells: list[Cell], inked: dict[str, Ink], *, numbers: bool
) -> dict[str, list[_Point]]:
    """Return the means of each policy along the axis; one without any is left out."""
    step = _SPREAD / max(len(inked) - 1, 1)
    places = {label: step * place - 0.5 * _SPREAD for place, label in enumerate(inked)}
    if len(inked) == 1:
        places = dict.fromkeys(inked, 0.0)
    found: dict[str, list[_Point]] = {}
    for group in groups:
        label, cell = str(group.cells[0]), group.cells[1]
        mean = group.means[at]
        if mean is None or (numbers and cell is None):
            continue
        x = float(cell or 0.0) if numbers else cells.index(cell) + places[label]
        found.setdefault(label, []).append(_Point(cell, x, mean, group.counts[at]))
    return found


def _axis_of_numbers(name: str, cells: Sequence[Cell]) -> Axis:
    values = [float(cell) for cell in cells if cell is not None]
    low, high = min(values), max(values)
    if low > 0.0 and high / low >= _LOG_FROM:
        return Axis(name, low / 1.1, 1.1 * high, "log")
    margin = 0.04 * (high - low)
    return Axis(name, low - margin, high + margin)


def _axis_of_names(name: str, cells: Sequence[Cell]) -> Axis:
    room = max(_LETTERS // len(cells), 3)
    texts = tuple(map(cell_text, cells))
    names = tuple(text if len(text) <= room else f"{text[: room - 1]}…" for text in texts)
    return Axis(name, -0.5, len(cells) - 0.5, names=names)


def _top(means: Sequence[float]) -> float:
    return max(1.1 * max(means, default=0.0), 1e-6)


def _caption(points: dict[str, list[_Point]]) -> str:
    """Return which policy differs most along the axis, and from what to what."""
    spans = [
        (max(some, key=lambda p: p.mean).mean - min(some, key=lambda p: p.mean).mean, label)
        for label, some in points.items()
    ]
    most, label = max(spans, key=lambda pair: pair[0], default=(0.0, ""))
    if not most > 0.0:
        return "The same for every value."
    low, high = (pick(points[label], key=lambda p: p.mean) for pick in (min, max))
    ends = (f"{format_value(p.mean)} ({short_name(cell_text(p.cell))})" for p in (low, high))
    return f"{short_name(label)} differs most: {' to '.join(ends)}."
