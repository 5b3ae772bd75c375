"""Charts of a report: over time, of distributions, after steps, and of trade-offs."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...sim.frame_log import FrameLog
from ..comparison import Comparison, PolicyResult
from ..metrics.metric import Metric
from ..metrics.registry import find_metric
from ..metrics.run import Run
from ..metrics.steps import Step
from .palette import Ink
from .series import bin_means, envelope, tail

__all__ = [
    "distribution_chart",
    "duel_chart",
    "largest_steps",
    "pareto_chart",
    "step_chart",
    "time_chart",
]

_BUCKETS = 700
_BIN_S = 0.5
_BEFORE_S, _AFTER_S = 0.25, 1.5
_MOST_STEPS = 6
_TICKS_MS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]
_NARROW = 8
_LOSE_TO_WIN = [[0, "#dd8452"], [0.5, "rgba(136,136,136,0.15)"], [1, "#3d85b8"]]
_BUDGET = {"color": "#888888", "width": 1.2, "dash": "dash"}


def time_chart(comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]) -> Any:
    """Return work, lag, switches and error over the time of the trace, below one another."""
    from plotly.subplots import make_subplots

    titles = [
        "Work time, ms",
        "Lag, ms",
        f"Switches of level per frame, means of {_BIN_S:g} s",
        "Projected error, 95th percentile of nodes, px",
    ]
    figure: Any = make_subplots(
        rows=4, cols=1, shared_xaxes=True, vertical_spacing=0.055, subplot_titles=titles,
        row_heights=[0.34, 0.22, 0.22, 0.22],
    )  # fmt: skip
    tops: list[list[float]] = [[], [], [], []]
    for policy in comparison.ok:
        run = Run(logs[policy.label])
        time_s = run.time_s
        edges = np.arange(0.0, time_s[-1] + _BIN_S, _BIN_S)
        rows = (
            envelope(time_s, run.work_ms, _BUCKETS),
            envelope(time_s, run.lag_ms, _BUCKETS),
            (0.5 * (edges[1:] + edges[:-1]), bin_means(time_s, run["toggles"], edges)),
            envelope(time_s, run["sse_px_p95"], _BUCKETS),
        )
        for row, (x, y) in enumerate(rows, 1):
            figure.add_scatter(
                x=_short(x), y=_short(y), row=row, col=1, showlegend=row == 1, **_line(policy, ink)
            )
            tops[row - 1].append(float(np.nanquantile(y, 0.99)))
    tops[0].append(comparison.budget_ms)
    for row, top in enumerate(tops, 1):
        figure.update_yaxes(range=(0.0, _top(top)), row=row, col=1)
    figure.add_hline(y=comparison.budget_ms, row=1, col=1, line=_BUDGET)
    figure.update_xaxes(title_text="time of the trace, s", row=4, col=1)
    return _styled(figure, 860, comparison.ok)


def _top(tops: list[float]) -> float:
    """Return the end of an axis: all that is reached, or thrice what the middle policy reaches."""
    middle = float(np.median(tops))
    highest = max(tops)
    return 1.1 * (min(highest, 3.0 * middle) if middle > 0.0 else max(highest, 1e-6))


def distribution_chart(
    comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]
) -> Any:
    """Return how many frames take how long: work time, and interval between displays."""
    from plotly.subplots import make_subplots

    titles = ["Work time", "Interval between displays"]
    figure: Any = make_subplots(rows=1, cols=2, shared_yaxes=True, subplot_titles=titles)
    for policy in comparison.ok:
        run = Run(logs[policy.label], comparison.warmup)
        for column, values in enumerate((run.work_ms, run.frame_ms), 1):
            x, y = tail(values, 300)
            figure.add_scatter(
                x=_short(x), y=_short(100.0 * y), row=1, col=column, showlegend=column == 1,
                line_shape="vh", **_line(policy, ink),
            )  # fmt: skip
    figure.add_vline(x=comparison.budget_ms, line=_BUDGET)
    figure.update_yaxes(type="log", title_text="frames at least this slow, %", col=1)
    figure.update_yaxes(type="log", dtick=1)
    figure.update_xaxes(type="log", title_text="ms", tickvals=_TICKS_MS)
    return _styled(figure, 350, comparison.ok)


def largest_steps(comparison: Comparison) -> list[Step]:
    """Return the steps to draw, in order of time: the largest rises that some policy met."""
    runs = [policy.steps for policy in comparison.ok if policy.steps]
    steps = max(runs, key=len, default=())
    rise = sorted(steps, key=lambda step: step.load_before_ms - step.load_after_ms)
    return sorted(rise[:_MOST_STEPS], key=lambda step: step.time_ms)


def step_chart(comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]) -> Any:
    """Return work over budget about each of the largest steps, or None where there is none."""
    from plotly.subplots import make_subplots

    steps = largest_steps(comparison)
    if not steps:
        return None
    columns = min(len(steps), 3)
    rows = -(-len(steps) // columns)
    titles = [
        f"{step.time_ms * 1e-3:.1f} s: load {step.load_before_ms:.1f} → {step.load_after_ms:.1f} ms"
        for step in steps
    ]
    figure: Any = make_subplots(
        rows=rows, cols=columns, shared_yaxes=True, subplot_titles=titles,
        vertical_spacing=0.5 / (2 * rows), horizontal_spacing=0.03,
    )  # fmt: skip
    tops = [1.0]
    for policy in comparison.ok:
        run = Run(logs[policy.label])
        time_s = run.time_s
        for i, step in enumerate(steps):
            since_s = time_s - step.time_ms * 1e-3
            near = (since_s >= -_BEFORE_S) & (since_s <= _AFTER_S)
            x, y = envelope(since_s[near], run.work_ms[near] / comparison.budget_ms, _BUCKETS)
            figure.add_scatter(
                x=_short(x), y=_short(y), row=1 + i // columns, col=1 + i % columns,
                showlegend=i == 0, **_line(policy, ink),
            )  # fmt: skip
            tops.append(float(np.max(y, initial=0.0)))
    figure.add_hline(y=1.0, line=_BUDGET)
    figure.update_yaxes(range=(0.0, _top(tops)))
    figure.update_yaxes(title_text="work / budget", col=1)
    figure.update_xaxes(title_text="s since the step", row=rows)
    return _styled(figure, 90 + 260 * rows, comparison.ok)


def pareto_chart(comparison: Comparison, ink: dict[str, Ink]) -> Any:
    """Return stability against lag, flicker and quality, with intervals; the front is filled."""
    from plotly.subplots import make_subplots

    first, *others = (find_metric(name) for name in comparison.pareto.metrics)
    figure: Any = make_subplots(rows=1, cols=len(others), horizontal_spacing=0.07)
    for policy in comparison.ok:
        marker = {"color": ink[policy.label].color, "size": 11, "symbol": ink[policy.label].symbol}
        if policy.label not in comparison.pareto.front:
            marker["symbol"] = f"{marker['symbol']}-open"
        for column, other in enumerate(others, 1):
            x, x_error = _point(policy, first)
            y, y_error = _point(policy, other)
            figure.add_scatter(
                x=[x], y=[y], error_x=x_error, error_y=y_error, row=1, col=column, marker=marker,
                showlegend=column == 1, name=policy.label, legendgroup=policy.label, mode="markers",
            )  # fmt: skip
    for column, other in enumerate(others, 1):
        figure.update_xaxes(title_text=_title(first), row=1, col=column)
        figure.update_yaxes(title_text=_title(other), row=1, col=column)
    return _styled(figure, 370, comparison.ok)


def duel_chart(comparison: Comparison) -> Any:
    """Return the probability that the policy of a row beats that of a column, by metric."""
    from plotly.subplots import make_subplots

    metrics = [metric for metric in comparison.pareto.metrics if metric in comparison.beats]
    labels = [policy.label for policy in comparison.ok]
    if not metrics or len(labels) < 2:
        return None
    columns = len(metrics) if len(labels) <= _NARROW else 2
    rows = -(-len(metrics) // columns)
    figure: Any = make_subplots(
        rows=rows, cols=columns, shared_yaxes=True, shared_xaxes=True, horizontal_spacing=0.02,
        vertical_spacing=0.08, subplot_titles=[_words(find_metric(metric)) for metric in metrics],
    )  # fmt: skip
    for i, metric in enumerate(metrics):
        table = [comparison.beats[metric][label] for label in labels]
        text = [["" if p is None else f"{100 * p:.0f}" for p in row] for row in table]
        figure.add_heatmap(
            z=table, x=labels, y=labels, text=text, texttemplate="%{text}", zmin=0, zmax=1,
            colorscale=_LOSE_TO_WIN, showscale=False, xgap=2, ygap=2, hoverongaps=False,
            row=1 + i // columns, col=1 + i % columns,
            hovertemplate="%{y} beats %{x}: %{text} %<extra></extra>",
        )  # fmt: skip
    figure.update_yaxes(autorange="reversed", showgrid=False)
    figure.update_xaxes(showgrid=False, tickangle=-45)
    return _styled(figure, 190 + rows * (60 + 28 * len(labels)))


def _point(policy: PolicyResult, metric: Metric) -> tuple[float | None, dict[str, Any]]:
    """Return a value and its error bar, fractions in per cent."""
    score = policy.metrics[metric.id]
    scale = 100.0 if metric.unit == "fraction" else 1.0
    if score.value is None or score.low is None or score.high is None:
        return score.value, {}
    up, down = max(score.high - score.value, 0.0), max(score.value - score.low, 0.0)
    return scale * score.value, {
        "type": "data", "array": [scale * up], "arrayminus": [scale * down],
        "thickness": 1, "width": 3,
    }  # fmt: skip


def _words(metric: Metric) -> str:
    """Return an id as words, without its unit."""
    return " ".join(word for word in metric.id.split("_") if word != metric.unit)


def _title(metric: Metric) -> str:
    return f"{_words(metric)}, {'%' if metric.unit == 'fraction' else metric.unit}"


def _line(policy: PolicyResult, ink: dict[str, Ink]) -> dict[str, Any]:
    drawn = ink[policy.label]
    return {
        "mode": "lines",
        "name": policy.label,
        "legendgroup": policy.label,
        "line": {"color": drawn.color, "dash": drawn.dash, "width": 1.4},
    }


def _short(values: Sequence[float] | Any) -> Any:
    """Return values with the digits that a chart shows, which makes the page smaller."""
    return np.asarray(values, dtype=np.float32)


def _styled(figure: Any, height_px: int, named: Sequence[PolicyResult] = ()) -> Any:
    """Return the figure with what all have in common; the page sets colours for light and dark."""
    # The legend stands above, as many lines as its names need.
    legend_px = 26 * -(-sum(len(policy.label) + 7 for policy in named) // 150)
    figure.update_layout(
        height=height_px + legend_px,
        margin={"l": 60, "r": 12, "t": 38 + legend_px, "b": 48},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"family": "system-ui, sans-serif", "size": 12, "color": "#808080"},
        legend={"orientation": "h", "x": 0, "y": 1.0, "yref": "container", "yanchor": "top"},
        hoverlabel={"namelength": -1},
        template="none",
    )
    line = {"gridcolor": "rgba(128,128,128,0.2)", "zeroline": False, "automargin": True}
    figure.update_xaxes(**line)
    figure.update_yaxes(**line)
    figure.update_annotations(font_size=12, selector={"showarrow": False})
    return figure
