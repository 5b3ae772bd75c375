"""Every metric of every policy, with its definition and source."""

from collections.abc import Iterator

from ...metrics.metric_registry import METRICS
from ..blocks import Across, Cell, Table
from ..results import Results, section
from ..summary import MetricColumn


@section("Every metric, its definition and its source", folded=True)
def every_metric(results: Results) -> tuple[Table]:
    """Below each value stands its {level} interval."""
    heads = ("metric", "unit", *map(results.name_of, results.drawn))
    return (Table(heads, list(_rows(results)), "metrics"),)


def _rows(results: Results) -> Iterator[tuple[Cell | str, ...] | Across]:
    group = ""
    for metric in METRICS:
        if metric.group != group:
            group = metric.group
            yield Across(group, "group")
        column = MetricColumn(metric.id, metric.id)
        shown = results.drawn
        values = (results.value_of(policy, column) for policy in shown)
        hint = f"{metric.definition}  Source: {metric.source}"
        yield Cell(metric.id, hint=hint), metric.unit, *values
        aside = f"{metric.better} is better.  Source: {metric.source}"
        yield Across(Cell(metric.definition, aside), "text")
