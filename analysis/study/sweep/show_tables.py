"""Tables that answer questions to the results of a study."""

from collections.abc import Sequence

from ....base.quantities import count_text
from ...metrics.metric_registry import find_metric
from ...report.values import format_value
from ..axes.grid import Cell
from .plain_table import PlainTable
from .query import Group, Query
from .sensitivities import Sensitivities


def list_runs(query: Query, metrics: Sequence[str], *, varied: bool = False) -> PlainTable:
    """Return a row a run: its place on the axes, its status and some metrics.

    Parameters
    ----------
    varied
        Leave out the axes on which the runs do not differ.
    """
    axes = query.results.axes
    if varied:
        axes = [name for name in axes if len(query.rows([name]).column(0).unique()) > 1] or axes[:1]
    header = (*axes, "status", *metrics)
    rows = query.rows(header)
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

    The last of several axes goes across.  A mean has the number of its runs behind it where that is
    not the same for all.
    """
    if len(axes) > 1:
        return [_across(query, groups, axes, at, metric) for at, metric in enumerate(metrics)]
    rows: list[tuple[Cell, ...]] = [
        (*group.cells, group.ok, *(_mean(group, at, group.ok) for at in range(len(metrics))))
        for group in groups
    ]
    header = (axes[0], "runs", *metrics)
    return [PlainTable("means over the runs", header, rows, _texts(query), (axes[0],))]


def sensitivity_rows(found: Sensitivities) -> PlainTable:
    """Return a row for each metric and axis: its share of the variance and the interval of that."""
    rows: list[tuple[Cell, ...]] = [
        (item.metric, axis, share.value, share.low, share.high)
        for item in found.metrics
        for axis, share in item.shares.items()
    ]
    title = f"shares of the variance of {count_text(found.runs, 'run')}"
    header = ("metric", "axis", "share", "low", "high")
    return PlainTable(title, header, rows, ("metric", "axis"))


def _across(
    query: Query, groups: Sequence[Group], axes: Sequence[str], at: int, metric: str
) -> PlainTable:
    columns = list(dict.fromkeys(group.cells[-1] for group in groups))
    ordered = [cell for (cell,) in (group.cells for group in query.groups([axes[-1]], []))]
    columns.sort(key=ordered.index)
    counts = {group.counts[at] for group in groups}
    same = min(counts) if len(counts) == 1 else -1
    over = f"over {count_text(same, 'run')}" if same >= 0 else "(runs)"
    rows: dict[tuple[Cell, ...], dict[Cell, Cell]] = {}
    for group in groups:
        rows.setdefault(group.cells[:-1], {})[group.cells[-1]] = _mean(group, at, same)
    header = (*axes[:-1], *(f"{axes[-1]}={_name(cell)}" for cell in columns))
    table = [(*cells, *(row.get(cell) for cell in columns)) for cells, row in rows.items()]
    title = f"{metric}, {find_metric(metric).unit}: means {over}"
    return PlainTable(title, header, table, _texts(query), tuple(axes))


def _mean(group: Group, at: int, expected: int) -> Cell:
    mean, count = group.means[at], group.counts[at]
    return mean if count in (0, expected) else f"{format_value(mean)} ({count:,})"


def _name(cell: Cell) -> str:
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)


def _texts(query: Query) -> tuple[str, ...]:
    """Return the axes whose cells are texts."""
    import pyarrow as pa

    schema = query.results.rows.schema
    return tuple(name for name in query.results.axes if schema.field(name).type == pa.string())
