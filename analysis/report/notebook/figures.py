"""Charts of a comparison as plotly figures, to be looked at and worked on in a notebook."""

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from math import log10
from typing import Any

from ....base.errors import InputError
from ....base.nearest_names import unknown_name
from ...study.comparison import Comparison
from ...study.comparison_parts import Curve, PolicyResult
from ..names import short_name
from ..palette import Ink, inks
from ..summary import shown_policies

_HEIGHT_PX = 440
_DRAWN_AT_FIRST = 6
"""Policies, the first of the ranking, that are drawn until a reader clicks others in the legend."""
_LEAST, _MOST = 0.22, 3.0
"""Work that is in view at first, in budgets."""

Point = tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class _Axes:
    """What a figure draws of each policy's curve, and of the point where it was set."""

    x: str
    y: str
    curve: Callable[[Curve], tuple[tuple[float, ...], tuple[float, ...]]]
    point: Callable[[PolicyResult], Point]


def draw_figure(comparison: Comparison, name: str) -> Any:
    """Return the plotly figure of a name in `FIGURES`; every name of a policy in it is text.

    Raises `InputError` for another name, with those that there are.
    """
    if name not in FIGURES:
        raise InputError(f"figure: {unknown_name(name, FIGURES)}")
    from plotly.graph_objects import Figure

    axes, inked = FIGURES[name], inks(comparison)
    figure = Figure()
    for place, policy in enumerate(shown_policies(comparison)):
        visible = True if place < _DRAWN_AT_FIRST else "legendonly"
        for trace in _traces(comparison, policy, axes, inked[policy.label]):
            figure.add_scatter(**trace, visible=visible)
    _style(figure, axes, comparison)
    return figure


def _traces(
    comparison: Comparison, policy: PolicyResult, axes: _Axes, ink: Ink
) -> list[dict[str, Any]]:
    """Return a policy's curve over its knob, and its point, which one click hides together."""
    name = as_text(short_name(policy.label))
    common: dict[str, Any] = {
        "name": name,
        "legendgroup": policy.label,
        "hovertemplate": f"%{{fullData.name}}<br>{axes.x} %{{x:.3g}}<br>{axes.y} %{{y:.3g}}"
        "<extra></extra>",
    }
    traces: list[dict[str, Any]] = []
    x, y = axes.point(policy)
    curve = comparison.curve.get(policy.label)
    if curve is not None:
        xs, ys = axes.curve(curve)
        line = {"color": ink.color, "dash": ink.dash, "width": 1.5}
        traces.append({**common, "x": xs, "y": ys, "mode": "lines", "line": line})
    if x is not None and y is not None:
        marker = {"color": ink.color, "symbol": ink.symbol, "size": 10}
        traces.append({**common, "x": [x], "y": [y], "mode": "markers", "marker": marker})
    for trace in traces[:-1]:
        trace["showlegend"] = False
    return traces


def _style(figure: Any, axes: _Axes, comparison: Comparison) -> None:
    """Set axes, margins and colours that are read on a light and on a dark page."""
    figure.update_layout(
        height=_HEIGHT_PX,
        margin={"l": 60, "r": 12, "t": 30, "b": 48},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"family": "system-ui, sans-serif", "size": 12, "color": "#808080"},
        hoverlabel={"namelength": -1},
        showlegend=True,
        template="none",
    )
    line = {"gridcolor": "rgba(128,128,128,0.2)", "zeroline": False, "automargin": True}
    figure.update_xaxes(title=axes.x, rangemode="tozero", **line)
    figure.update_yaxes(title=axes.y, rangemode="tozero", **line)
    if axes is _ERROR_OVER_WORK:
        _mark_budget(figure, comparison.budget_ms)


def _mark_budget(figure: Any, budget_ms: float) -> None:
    """Make the axis of work one of doublings around the budget, with a line at that."""
    ends = [log10(_LEAST * budget_ms), log10(_MOST * budget_ms)]
    ticks = [m * 10.0**power for power in range(-4, 7) for m in (1, 2, 5)]
    figure.update_xaxes(type="log", range=ends, tickvals=ticks, ticktext=[f"{t:g}" for t in ticks])
    figure.add_vline(budget_ms, line={"color": "#888888", "width": 1.2, "dash": "dash"})
    figure.add_annotation(
        text=f"budget {budget_ms:.4g} ms", x=log10(budget_ms), y=1.0, yref="paper",
        yanchor="bottom", showarrow=False,
    )  # fmt: skip


def as_text(name: str) -> str:
    """Return a name so that plotly, which reads tags, entities and TeX, shows it as it is."""
    return escape(name, quote=False).replace("$", "&#36;")


def _work_ms(policy: PolicyResult) -> float | None:
    return None if policy.keeps_budget is None else policy.keeps_budget.work_ms


_ERROR, _POPS = "visible_error_px", "visible_pops_per_s"
_ERROR_OVER_WORK = _Axes(
    "work at the judged quantile, ms",
    "visible error, px",
    lambda curve: (curve.work_ms, curve.visible_error_px),
    lambda policy: (_work_ms(policy), policy.value_of(_ERROR)),
)
_SWITCHES_OVER_ERROR = _Axes(
    "visible error, px",
    "visible pops, /s",
    lambda curve: (curve.visible_error_px, curve.pops_per_s),
    lambda policy: (policy.value_of(_ERROR), policy.value_of(_POPS)),
)

FIGURES = {"tradeoff": _ERROR_OVER_WORK, "switches": _SWITCHES_OVER_ERROR}
"""By name: what each policy's error is at which work, and its switches at which error."""
