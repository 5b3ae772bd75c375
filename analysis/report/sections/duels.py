"""Which policy beats which, with what probability."""

from typing import Any

from ...metrics.metric_registry import find_metric
from ..blocks import Chart, Paragraph
from ..results import Results, section
from ..style import panels, styled
from ..values import metric_words

_LOSE_TO_WIN = [[0, "#dd8452"], [0.5, "rgba(136,136,136,0.15)"], [1, "#3d85b8"]]
_NARROW = 8
"""With more policies than this the tables of probabilities stand two beside each other."""


@section("Which beats which")
def duels(results: Results) -> tuple[Chart, Paragraph]:
    """Probability in per cent that the policy of a row is better than that of a column.

    Resamples are paired: the same blocks of time and the same noise for both.  A tie counts half.
    """
    draws = results.comparison.intervals.draws
    text = f"Resampled over {draws} posterior draws of the cost model." if draws else ""
    return results.chart("duels", _chart), Paragraph(text, "dim")


def _chart(results: Results) -> Any:
    comparison = results.comparison
    metrics = [metric for metric in comparison.pareto.metrics if metric in comparison.beats]
    labels = [policy.label for policy in comparison.ok]
    if not metrics or len(labels) < 2:
        return None
    columns = len(metrics) if len(labels) <= _NARROW else 2
    rows = -(-len(metrics) // columns)
    figure = panels(
        rows, columns, shared_yaxes=True, shared_xaxes=True, horizontal_spacing=0.02,
        vertical_spacing=0.08, subplot_titles=[metric_words(find_metric(m)) for m in metrics],
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
