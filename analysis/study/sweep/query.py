"""Questions to the results of a study, in SQL."""

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ....base.errors import InputError
from ....base.nearest_names import unknown_name
from ....base.quantities import count_text
from ...metrics.metric_registry import METRICS
from ..axes.grid import Cell
from .study_results import StudyResults

if TYPE_CHECKING:
    import duckdb
    import pyarrow as pa

_EXAMPLE = "budget_ms < 20 and policy = 'zach'"
_UNKNOWN = re.compile(r'(?:column|binding|table) "([^"]*)" not found', re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Group:
    """Runs that have the same cells on some axes.

    Attributes
    ----------
    cells : tuple of Cell
        On the axes asked for.
    ok, failed, not_applicable : int
        Runs by status.
    means : tuple of float or None
        Of each metric over the runs that have it; None if none has.
    counts : tuple of int
        Runs that have each metric.
    """

    cells: tuple[Cell, ...]
    ok: int
    failed: int
    not_applicable: int
    means: tuple[float | None, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Unscored:
    """Runs of one policy that have no scores for one reason."""

    policy: str
    status: str
    reason: str
    frame: int | None
    runs: int

    @property
    def text(self) -> str:
        """One line about them."""
        reason = self.reason if self.frame is None else f"frame {self.frame}: {self.reason}"
        runs, status = count_text(self.runs, "run"), self.status.replace("-", " ")
        return f"{self.policy}: {runs} {status}: {reason}"


class Query:
    """Those rows of results for which a condition holds.

    Raises `InputError` if the condition is no SQL expression over the columns, with the nearest
    column.

    Parameters
    ----------
    results
    where
        A condition as SQL has it behind WHERE; None for all rows.
    """

    def __init__(self, results: StudyResults, where: str | None = None) -> None:
        import duckdb

        self.results = results
        # The condition sees these rows and nothing else: no file, no address, no variable of ours.
        # One thread adds in one order, so that a mean has the same last bit every time.
        sealed: dict[str, str | bool | int | float | list[str]] = {
            "enable_external_access": "false",
            "python_enable_replacements": "false",
            "lock_configuration": "true",
            "threads": "1",
        }
        self._connection = duckdb.connect(":memory:", config=sealed)
        rows = self._connection.from_arrow(results.rows)
        try:
            self._rows = (rows if where is None else rows.filter(where)).set_alias("runs")
            self._rows.aggregate(
                "count(*)"
            ).fetchall()  # a text that is no number is found only now
        except duckdb.Error as error:
            raise self._explained(error, where or "") from error

    def __len__(self) -> int:
        """Return the number of rows."""
        return int(self._all("count(*)")[0][0])

    def rows(self, columns: Sequence[str]) -> "pa.Table":
        """Return some columns, in the order of the study."""
        return self._rows.project(", ".join(map(_quoted, columns))).to_arrow_table()

    def groups(self, axes: Sequence[str], metrics: Sequence[str]) -> list[Group]:
        """Return the means of metrics over all runs that have the same cells on some axes.

        Numbers are in ascending order, texts in that of the study, and null first.
        """
        by = ", ".join(map(_quoted, axes))
        statuses = ("ok", "failed", "not-applicable")
        counts = [f"count(*) FILTER (status = '{status}')" for status in statuses]
        values = [f"avg({_quoted(name)}), count({_quoted(name)})" for name in metrics]
        found = self._all(", ".join([*map(_quoted, axes), *counts, *values]), by)
        width = len(axes)
        groups = [
            Group(
                cells=row[:width],
                ok=row[width],
                failed=row[width + 1],
                not_applicable=row[width + 2],
                means=row[width + 3 :: 2],
                counts=row[width + 4 :: 2],
            )
            for row in found
        ]
        places = [_order(self.rows([axis]).column(0).unique().to_pylist()) for axis in axes]
        return sorted(
            groups,
            key=lambda group: [
                place[cell] for place, cell in zip(places, group.cells, strict=True)
            ],
        )

    def unscored(self) -> list[Unscored]:
        """Return who has runs without scores and why, the most first."""
        by = "policy, status, reason, frame"
        found = self._rows.filter("status <> 'ok'").aggregate(f"{by}, count(*) AS runs", by)
        rows = [Unscored(*row) for row in found.fetchall()]
        return sorted(rows, key=lambda row: (row.status, -row.runs, row.text))

    def _all(self, columns: str, by: str = "") -> list[tuple[Any, ...]]:
        return self._rows.aggregate(columns, by).fetchall()

    def _explained(self, error: "duckdb.Error", where: str) -> InputError:
        """Return what a user is told about a condition that the database refuses."""
        reason = str(error).partition("\n")[0]
        unknown = _UNKNOWN.search(str(error))
        if unknown:
            name = unknown[1]
            near = difflib.get_close_matches(name, metric_ids(), 1)
            known = [*self.results.axes, "label", "status", "frames", *near]
            advice = f"a text stands in single quotes: '{name}'"
            said = unknown_name(name, known, instead="a metric", advice=advice)
            return InputError(f"--where: {said}")
        message = f"expected a condition such as {_EXAMPLE!r}, got {where!r}"
        return InputError(f"--where: {message}: {reason}")


def require_columns(given: Sequence[str], known: Sequence[str], option: str) -> None:
    """Raise `InputError` if an option names a column that is not one of these."""
    for name in given:
        if name not in known:
            raise InputError(f"{option}: {unknown_name(name, known)}")
        if given.count(name) > 1:
            raise InputError(f"{option}: expected each once, got {name} twice; name it once")


def metric_ids() -> list[str]:
    """Return the columns that are metrics."""
    return [metric.id for metric in METRICS]


def _order(cells: Sequence[Cell]) -> dict[Cell, int]:
    """Return the place of each cell among those of its column."""
    texts = any(isinstance(cell, str) for cell in cells)
    known = [cell for cell in cells if cell is not None]
    ordered = known if texts else sorted(known)  # pyright: ignore[reportArgumentType, reportCallIssue]
    return {cell: place for place, cell in enumerate((None, *ordered))}


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
