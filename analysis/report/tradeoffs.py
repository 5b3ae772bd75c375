"""Charts of trade-offs: what a policy gives for what, and which policy beats which."""

from typing import Any

from ..metrics.metric import Metric
from ..metrics.metric_registry import find_metric
from ..study.comparison import Comparison, PolicyResult
from .palette import Ink
from .style import styled

_LOSE_TO_WIN = [[0, "#dd8452"], [0.5, "rgba(136,136,136,0.15)"], [1, "#3d85b8"]]
_NARROW = 8
"""With more policies than this the tables of probabilities stand two beside each other."""


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
    return styled(figure, 370, comparison.ok)


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
    return styled(figure, 190 + rows * (60 + 28 * len(labels)))


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
