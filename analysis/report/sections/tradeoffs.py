"""What a policy gives for what: picture error and switches over work, as its knob turns."""

from collections.abc import Callable, Sequence

import numpy as np

from ...study.comparison_parts import Curve, PolicyResult
from ..blocks import Paragraph
from ..names import short_name
from ..plots import (
    Axis,
    Line,
    Mark,
    Plot,
    Plots,
    Rule,
    label_height_px,
    label_marks,
    line_of,
    mark_of,
)
from ..results import Results, section
from ..values import format_value

_FIRST_PX, _SECOND_PX = 400, 340
_LEAST, _MOST = 0.22, 3.0
"""Work that the first chart shows, in budgets: beyond, nobody is set."""


@section("What each policy gives for its work")
def tradeoffs(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """Each line is a policy as its knob turns; its point is where it was set for this budget.

    Lower is better, and left is cheaper.  Work is the time that budgets judge, the mean over paths.
    Both scales are bent: doublings of work, and square roots of what is seen, count alike.  What is
    off the scale stands at its end, with an arrow and its work.
    """
    if not results.drawn:
        return (Paragraph("Nothing to draw in this run.", "dim"),)
    return (Plots([_error_over_work(results), _switches_over_error(results)]),)


def _error_over_work(results: Results) -> Plot:
    comparison = results.comparison
    budget = comparison.budget_ms
    quantile = f"{100.0 * (1.0 - comparison.miss):g}"
    placed = {p.label: p.keeps_budget.work_ms for p in results.drawn if p.keeps_budget}
    works = [w for curve in comparison.curve.values() for w in curve.work_ms] + [*placed.values()]
    low = max(0.9 * min(works, default=budget), _LEAST * budget)
    high = min(1.1 * max(works, default=budget), _MOST * budget)
    x = Axis(f"work at {quantile} % of the time, ms", low, max(high, 1.2 * budget), "log")
    y = Axis("visible error, px", 0.0, _top(results, "visible_error_px"), "root")
    marks, texts = _marks(results, (x, y), lambda p: (placed.get(p.label), _error(p)))
    lines = _lines(results, (x, y), lambda curve: (curve.work_ms, curve.visible_error_px))
    height_px = label_height_px(len(marks), _FIRST_PX)
    labels, leaders = label_marks(marks, texts, height_px)
    return Plot(
        "tradeoff", "Picture error against work", x, y, [*leaders, *lines], marks, labels,
        [Rule(True, round(100.0 * x.at(budget), 2), f"budget {budget:.4g} ms")], height_px,
        caption=_caption(results),
    )  # fmt: skip


def _switches_over_error(results: Results) -> Plot:
    x = Axis("visible error, px", 0.0, _top(results, "visible_error_px"), "root")
    y = Axis("visible pops, /s", 0.0, _top(results, "visible_pops_per_s"), "root")
    marks, texts = _marks(results, (x, y), lambda p: (_error(p), p.value_of("visible_pops_per_s")))
    lines = _lines(results, (x, y), lambda curve: (curve.visible_error_px, curve.pops_per_s))
    height_px = label_height_px(len(marks), _SECOND_PX)
    labels, leaders = label_marks(marks, texts, height_px)
    return Plot(
        "switches", "Switches that are seen against picture error", x, y, [*leaders, *lines],
        marks, labels, height_px=height_px,
        caption=_fewest(results),
    )  # fmt: skip


_Pair = tuple[float | None, float | None]


def _marks(
    results: Results, axes: tuple[Axis, Axis], place: Callable[[PolicyResult], _Pair]
) -> tuple[list[Mark], list[str]]:
    """Return the chosen points and their names; one off the scale is at its end, and says where."""
    marks: list[Mark] = []
    texts: list[str] = []
    for policy in results.drawn:
        x, y = place(policy)
        if x is None or y is None:
            continue
        name = short_name(policy.label)
        marks.append(mark_of(results.inks[policy.label], axes, x, y, name))
        texts.append(name + _off_scale(axes[0], x))
    return marks, texts


def _off_scale(axis: Axis, value: float) -> str:
    """Return which way and how far off a scale a value lies, nothing where it lies on it."""
    if axis.low <= value <= axis.high:
        return ""
    return f" {'→' if value > axis.high else '←'} {format_value(value)}"


def _lines(
    results: Results,
    axes: tuple[Axis, Axis],
    of: Callable[[Curve], tuple[Sequence[float], Sequence[float]]],
) -> list[Line]:
    curves = results.comparison.curve
    known = [(results.inks[p.label], curves[p.label]) for p in results.drawn if p.label in curves]
    return [
        line_of(ink, axes, (np.array(of(curve)[0]), np.array(of(curve)[1]))) for ink, curve in known
    ]


def _error(policy: PolicyResult) -> float | None:
    return policy.value_of("visible_error_px")


def _top(results: Results, metric: str) -> float:
    """Return the end of an axis that holds every chosen point."""
    values = [policy.value_of(metric) or 0.0 for policy in results.drawn]
    return max(1.15 * max(values, default=0.0), 1e-3)


def _caption(results: Results) -> str:
    """Return what the first of the ranking draws, and who draws the finest picture."""
    ranked = [policy for policy in results.drawn if policy.rank is not None]
    known = [(error, policy) for policy in ranked if (error := _error(policy)) is not None]
    if not known:
        return "Nobody surely keeps the budget."
    error, finest = min(known, key=lambda pair: pair[0])
    text = f"{finest.label} draws the finest picture of those that surely keep the budget"
    text += f", with {format_value(error)} px of visible error"
    if finest is not ranked[0]:
        text += f"; {ranked[0].label}, the first of the ranking, has {format_value(known[0][0])} px"
    return results.words(f"{text}.")


def _fewest(results: Results) -> str:
    """Return who switches least to be seen, of those that surely keep the budget."""
    known = [
        (pops, policy.label)
        for policy in results.drawn
        if policy.rank is not None and (pops := policy.value_of("visible_pops_per_s")) is not None
    ]
    corner = "The lower left corner draws the finest picture with the fewest switches"
    if not known:
        return f"{corner}."
    pops, fewest = min(known, key=lambda pair: pair[0])
    return results.words(
        f"{corner}; of those that surely keep the budget {fewest} has fewest, "
        f"{format_value(pops)} visible pops a second."
    )
