"""Every metric of every policy, with its definition and source."""

from collections.abc import Iterator

from ...metrics.metric_registry import METRICS
from ..blocks import Across, Cell, Table
from ..results import Results, section


@section("Every metric, its definition and its source", folded=True)
def every_metric(results: Results) -> tuple[Table]:
    """Best of each metric in green, with the {level} interval below each value."""
    heads = ("metric", "unit", *map(results.name_of, results.comparison.ok))
    return (Table(heads, list(_rows(results)), "metrics"),)


def _rows(results: Results) -> Iterator[tuple[Cell | str, ...] | Across]:
    group = ""
    for metric in METRICS:
        if metric.group != group:
            group = metric.group
            yield Across(group, "group")
        values = (results.value_of(policy, metric.id) for policy in results.comparison.ok)
        hint = f"{metric.definition}  Source: {metric.source}"
        yield Cell(metric.id, hint=hint), metric.unit, *values
        aside = f"{metric.better} is better.  Source: {metric.source}"
        yield Across(Cell(metric.definition, aside), "text")
