"""Tables that answer questions to the results of a study."""

from collections.abc import Sequence

from ...metrics.metric_registry import find_metric
from ...report.values import format_value
from ..axes.grid import Cell
from .plain_table import PlainTable
from .query import Group, Query
from .sensitivities import Sensitivities

LISTED = 40
"""Runs that a terminal is shown."""


def list_runs(query: Query, metrics: Sequence[str], limit: int | None = None) -> PlainTable:
    """Return a row a run: its place on the axes, its status and some metrics.

    Parameters
    ----------
    limit
        Show so many runs, and of the axes only those on which they differ.
    """
    axes = query.results.axes
    if limit is not None:
        axes = [name for name in axes if len(query.rows([name]).column(0).unique()) > 1] or axes[:1]
    header = (*axes, "status", *metrics)
    rows = query.rows(header).slice(0, limit)
    columns = [rows.column(name).to_pylist() for name in header]
    cells = list(zip(*columns, strict=True))
    return PlainTable("runs", header, cells, (*_texts(query), "status"), tuple(axes))


def pivot_rows(
    query: Query, groups: Sequence[Group], axes: Sequence[str], metrics: Sequence[str]
) -> PlainTable:
    """Return a row for each combination: its runs by status, and of each metric its mean and runs.

    This is what CSV has: nothing in it needs to be read from a header.
    """
    counted = [name for metric in metrics for name in (metric, f"{metric}_runs")]
    header = (*axes, "ok", "failed", "not_applicable", *counted)
    rows = [
        (
            *(*group.cells, group.ok, group.failed, group.not_applicable),
            *(item for pair in zip(group.means, group.counts, strict=True) for item in pair),
        )
        for group in groups
    ]
    return PlainTable("means over all other axes", header, rows, _texts(query), tuple(axes))


def pivot_tables(
    query: Query, groups: Sequence[Group], axes: Sequence[str], metrics: Sequence[str]
) -> list[PlainTable]:
    """Return means as one reads them: of one axis all metrics, of more a table a metric.

    The last of several axes goes across.  A mean over fewer runs than the others has their number
    behind it.
    """
    if len(axes) > 1:
        return [_across(query, groups, axes, at, metric) for at, metric in enumerate(metrics)]
    usual = max((count for group in groups for count in group.counts), default=0)
    rows = [
        (group.cells[0], *(_mean(group, at, usual) for at in range(len(metrics))))
        for group in groups
    ]
    header = (axes[0], *metrics)
    return [PlainTable(f"means over {usual:,} runs", header, rows, _texts(query), (axes[0],))]


def sensitivity_rows(found: Sensitivities) -> PlainTable:
    """Return a row for each metric and axis: its share of the variance and the interval of that."""
    rows: list[tuple[Cell, ...]] = [
        (item.metric, axis, share.value, share.low, share.high)
        for item in found.metrics
        for axis, share in item.shares.items()
    ]
    title = f"share of the variance of {found.runs:,} runs, with its 90 % interval over seeds"
    header = ("metric", "axis", "share", "low", "high")
    return PlainTable(title, header, rows, ("metric", "axis"))


def _across(
    query: Query, groups: Sequence[Group], axes: Sequence[str], at: int, metric: str
) -> PlainTable:
    usual = max((group.counts[at] for group in groups), default=0)
    columns = list(dict.fromkeys(group.cells[-1] for group in groups))
    ordered = [cell for (cell,) in (group.cells for group in query.groups([axes[-1]], []))]
    columns.sort(key=ordered.index)
    rows: dict[tuple[Cell, ...], dict[Cell, Cell]] = {}
    for group in groups:
        rows.setdefault(group.cells[:-1], {})[group.cells[-1]] = _mean(group, at, usual)
    header = (*axes[:-1], *(f"{axes[-1]}={_name(cell)}" for cell in columns))
    table = [(*cells, *(row.get(cell) for cell in columns)) for cells, row in rows.items()]
    title = f"{metric}, {find_metric(metric).unit}: means over {usual:,} runs"
    return PlainTable(title, header, table, _texts(query), tuple(axes))


def _mean(group: Group, at: int, usual: int) -> Cell:
    mean, count = group.means[at], group.counts[at]
    return mean if count in (0, usual) else f"{format_value(mean)} ({count:,})"


def _name(cell: Cell) -> str:
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)


def _texts(query: Query) -> tuple[str, ...]:
    """Return the axes whose cells are texts."""
    import pyarrow as pa

    schema = query.results.rows.schema
    return tuple(name for name in query.results.axes if schema.field(name).type == pa.string())
