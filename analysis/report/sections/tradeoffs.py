"""What a policy gives for what: stability against lag, flicker and quality."""

from typing import Any

from ...metrics.metric import Metric
from ...metrics.metric_registry import find_metric
from ...study.comparison import PolicyResult
from ..blocks import Chart
from ..results import Results, section
from ..style import panels, styled
from ..values import metric_words

_AXES = ("over_budget_time_fraction", "lag_ms_mean", "visible_pops_per_s", "visible_error_px")


@section("Trade-offs")
def tradeoffs(results: Results) -> tuple[Chart]:
    """Lower left is better in each.

    Bars are {level} intervals.
    """
    return (results.chart("tradeoffs", _chart),)


def _chart(results: Results) -> Any:
    comparison = results.comparison
    first, *others = (find_metric(name) for name in _AXES)
    figure = panels(1, len(others), horizontal_spacing=0.07)
    for policy in comparison.ok:
        ink = results.inks[policy.label]
        marker = {"color": ink.color, "size": 11, "symbol": ink.symbol}
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


def _title(metric: Metric) -> str:
    return f"{metric_words(metric)}, {'%' if metric.unit == 'fraction' else metric.unit}"
