"""The table of the terminal, with the interval below each value."""

from dataclasses import replace

from ...metrics.metric_registry import find_metric
from ...study.comparison import PolicyResult
from ..blocks import Cell, Table
from ..results import Results, section
from ..summary import HEADLINE, MetricColumn


@section("Policies side by side")
def headline(results: Results) -> tuple[Table]:
    """Best of each column in green, with the {level} interval below each value.

    An oracle sees the true cost of frames; it shows what is possible and takes no part.
    """
    rows = [
        (_name(results, policy), *(_value(results, policy, column) for column in HEADLINE))
        for policy in results.comparison.ok
    ]
    return (Table(("policy", *map(_head, HEADLINE)), rows),)


def _head(column: MetricColumn) -> Cell:
    header = " ".join(column.header.split()).replace("- ", "")
    return Cell(header, hint=find_metric(column.metric).definition)


def _name(results: Results, policy: PolicyResult) -> Cell:
    return results.name_of(policy, ("oracle",) * policy.oracle)


def _value(results: Results, policy: PolicyResult, column: MetricColumn) -> Cell:
    cell = results.value_of(policy, column.metric, percent=column.percent)
    return replace(cell, text=column.text(policy))
