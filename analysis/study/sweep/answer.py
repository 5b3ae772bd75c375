"""An answer from the results of a study: its runs, means of them, or what they depend on."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ....base.errors import InputError
from ....base.quantities import count_text
from ..comparison import SHOWN
from .plain_table import PlainTable
from .query import Query, metric_ids, require_columns
from .sensitivities import find_sensitivities
from .show_tables import list_runs, pivot_rows, pivot_tables, sensitivity_rows
from .study_results import StudyResults, read_study_results

SCHEMA = "lodbench.sweep-show/1"
_LISTED = ("work_ms_p95", "sse_px_p95")
"""Metrics that a list of runs has unless it is told which."""
_REASONS = 10
"""Reasons for which runs have no scores that are told as notes; the record has all."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What a question found.

    Attributes
    ----------
    kind : str
        ``list``, ``pivot`` or ``sensitivity``.
    about : dict
        What answers of every kind say in JSON.
    exact : PlainTable
        All of it, a row a run, a combination, or a share.
    tables : list of PlainTable
        The same as one reads it.
    notes : list of str
        What is missing, failed or left out, a line each.
    """

    kind: str
    about: dict[str, Any]
    exact: PlainTable
    tables: list[PlainTable]
    notes: list[str]

    def record(self) -> dict[str, Any]:
        """Return the answer as JSON has it."""
        rows = [dict(zip(self.exact.header, row, strict=True)) for row in self.exact.rows]
        return {"schema": SCHEMA, **self.about, self.kind: rows, "notes": self.notes}


def find_answer(
    folder: Path,
    *,
    where: str | None = None,
    pivot: Sequence[str] | None = None,
    metrics: Sequence[str] | None = None,
    sensitivity: bool = False,
) -> Answer:
    """Answer a question from a folder of results.

    Raises `InputError` if the folder holds none, the condition, an axis or a metric is unknown, no
    run matches, or both means and sensitivities are asked for.

    Parameters
    ----------
    where
        A condition on the columns, in SQL.
    pivot
        Axes of a table of means; None for a list of runs.
    metrics
        None for those that stand for each group of metrics; in a list for two of them.
    sensitivity
        Whether shares of variance are wanted.
    """
    results = read_study_results(folder)
    few = SHOWN if sensitivity or pivot is not None else _LISTED
    metrics = list(metrics or few)
    require_columns(metrics, metric_ids(), "--metric")
    if pivot is not None:
        require_columns(pivot, results.axes, "--pivot")
        if sensitivity:
            raise InputError("--pivot: expected no --sensitivity beside it; ask for one of both")
    query = Query(results, where)
    if not len(query):
        raise InputError("--where: expected a condition that holds for a run, got none; widen it")
    about, notes = _about(folder, query)
    if sensitivity:
        found = find_sensitivities(query, metrics)
        table = sensitivity_rows(found)
        about |= {"grid_runs": found.runs, "seeds": found.seeds}
        return Answer("sensitivity", about, table, [table], [*notes, *found.notes])
    if pivot is not None:
        groups = query.groups(pivot, metrics)
        exact = pivot_rows(query, groups, pivot, metrics)
        return Answer("pivot", about, exact, pivot_tables(query, groups, pivot, metrics), notes)
    brief = list_runs(query, metrics, varied=True)
    return Answer("list", about, list_runs(query, metrics), [brief], notes)


def _about(folder: Path, query: Query) -> tuple[dict[str, Any], list[str]]:
    """Return what is said of every question: how many runs there are, and which have no scores."""
    results: StudyResults = query.results
    reasons = query.unscored()
    failed, unfit = (
        sum(one.runs for one in reasons if one.status == status)
        for status in ("failed", "not-applicable")
    )
    about = {
        "folder": str(folder),
        "runs": results.runs,
        "done": len(results),
        "matching": len(query),
        "ok": len(query) - failed - unfit,
        "failed": failed,
        "not_applicable": unfit,
        "unscored": [asdict(one) for one in reasons],
        "axes": results.axes,
    }
    notes = [one.text for one in reasons[:_REASONS]]
    if len(reasons) > _REASONS:
        notes.append(f"and {count_text(len(reasons) - _REASONS, 'more reason')}")
    if len(results) < results.runs:
        left = f"{results.runs - len(results):,} of {results.runs:,} runs are not done yet"
        notes.append(f"{left}: run the study again to go on")
    return about, notes
