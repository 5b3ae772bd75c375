"""What a policy gives for what as its knob turns: error over work, and switches over error."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...study.comparison_parts import PolicyResult
from .drawing import clear_spines, new_figure
from .labels import Label, label_points
from .sheet import BUDGET_COLOR, DASHES, MARKERS, Sheet

_HEIGHT_IN = {True: 2.6, False: 3.4}  # of a column, of a page
_LABEL_IN = 0.115  # from one label to the next, at least
_AROUND_IN = 0.65  # title of the axis and margins


@dataclass(frozen=True, slots=True)
class _Line:
    """A policy's curve, and the point where it was set; None where it has none."""

    policy: PolicyResult
    x: tuple[float, ...]
    y: tuple[float, ...]
    at: tuple[float, float] | None


def draw_error_over_work(sheet: Sheet) -> Any:
    """Draw visible error over work time, with the budget as a line."""
    comparison = sheet.comparison
    lines: list[_Line] = []
    for policy in sheet.policies:
        curve, keeps = comparison.curve.get(policy.label), policy.keeps_budget
        error_px = policy.value_of("visible_error_px")
        at = None if keeps is None or error_px is None else (keeps.work_ms, error_px)
        x, y = ((), ()) if curve is None else (curve.work_ms, curve.visible_error_px)
        lines.append(_Line(policy, x, y, at))
    figure, axes = _axes(sheet, lines)
    axes.set_xscale("log")
    ends = _ends([x for line in lines for x in (*line.x, *_first(line.at))])
    _plain_ticks(axes.xaxis, ends)
    axes.set_xlim(ends)
    axes.axvline(comparison.budget_ms, color=BUDGET_COLOR, lw=0.8, ls="--", zorder=1)
    axes.annotate(
        sheet.budget_text(), (comparison.budget_ms, 1.0), xycoords=("data", "axes fraction"),
        xytext=(0, 2), textcoords="offset points", ha="center", va="bottom", color=BUDGET_COLOR,
    )  # fmt: skip
    axes.set_xlabel(f"work time at {100.0 * (1.0 - comparison.miss):g} % of the time, ms")
    axes.set_ylabel("visible error, px")
    _end_at(axes, lines)
    label_points(axes, _labels(sheet, lines), _LABEL_IN)
    return figure


def draw_switches_over_error(sheet: Sheet) -> Any:
    """Draw visible pops, on an axis that is linear up to 1 a second, over visible error."""
    lines: list[_Line] = []
    for policy in sheet.policies:
        curve = sheet.comparison.curve.get(policy.label)
        error_px, pops = policy.value_of("visible_error_px"), policy.value_of("visible_pops_per_s")
        at = None if error_px is None or pops is None else (error_px, pops)
        x, y = ((), ()) if curve is None else (curve.visible_error_px, curve.pops_per_s)
        lines.append(_Line(policy, x, y, at))
    figure, axes = _axes(sheet, lines)
    right = _top([x for line in lines for x in (*line.x, *_first(line.at))])
    axes.set_xlim(-0.02 * right, right)
    axes.set_xlabel("visible error, px")
    axes.set_ylabel("visible pops per second")
    axes.set_yscale("symlog", linthresh=1.0)
    highest = _top([y for line in lines for y in (*line.y, *_last(line.at))])
    _plain_ticks(axes.yaxis, (0.0, highest))
    axes.set_ylim(-0.1, highest)
    label_points(axes, _labels(sheet, lines), _LABEL_IN)
    return figure


def _axes(sheet: Sheet, lines: list[_Line]) -> tuple[Any, Any]:
    """Return a figure, high enough for its labels, with the curves and chosen points."""
    height_in = max(_HEIGHT_IN[sheet.width_in < 5.0], _LABEL_IN * len(lines) + _AROUND_IN)
    figure = new_figure(sheet.width_in, height_in)
    axes = figure.add_subplot()
    clear_spines(axes)
    for line in lines:
        ink = sheet.inks[line.policy.label]
        axes.plot(line.x, line.y, DASHES[ink.dash], color=ink.color, lw=0.9)
    for line in lines:
        if line.at is not None:
            ink = sheet.inks[line.policy.label]
            axes.plot(
                *line.at, MARKERS[ink.symbol], color=ink.color, ms=4.0, mec="white", mew=0.4,
                clip_on=False, zorder=4,
            )  # fmt: skip
    return figure, axes


def _end_at(axes: Any, lines: list[_Line]) -> None:
    """End the y axis above the chosen points; curves may go on beyond."""
    top = _top([y for line in lines for y in _last(line.at)])
    axes.set_ylim(-0.02 * top, top)


def _labels(sheet: Sheet, lines: list[_Line]) -> list[Label]:
    names = sheet.names()
    return [
        Label(names[line.policy.label], *line.at, sheet.inks[line.policy.label].color)
        for line in lines
        if line.at is not None
    ]


def _top(values: list[float]) -> float:
    """Return the end of an axis that holds all values, 0 included."""
    return 1.05 * max((value for value in values if np.isfinite(value)), default=1.0) or 1.0


def _first(at: tuple[float, float] | None) -> tuple[float, ...]:
    return () if at is None else at[:1]


def _last(at: tuple[float, float] | None) -> tuple[float, ...]:
    return () if at is None else at[1:]


def _ends(values: list[float]) -> tuple[float, float]:
    known = [value for value in values if value > 0.0 and np.isfinite(value)] or [1.0]
    return 0.9 * min(known), 1.1 * max(known)


def _plain_ticks(axis: Any, ends: tuple[float, float]) -> None:
    """Mark 1, 2, 5, 10, … on a logarithmic axis, as plain numbers, and 0 if it has that."""
    low, high = ends
    decades = range(int(np.floor(np.log10(low or 1.0))), int(np.ceil(np.log10(high))) + 1)
    ticks = [m * 10.0**d for d in decades for m in (1, 2, 5) if low <= m * 10.0**d <= high]
    if not low:
        ticks.insert(0, 0.0)
    axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_ticks([], minor=True)
