"""What became of the runs of a study."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from ....base.errors import InputError
from ....base.html_table import html_table
from ....base.quantities import count_text
from ...metrics.metric_registry import METRICS
from ..comparison import SHOWN
from ..results.manifest import read_manifest
from ..results.parts import column_names, read_part
from ..results.record import schema_of
from ..study import BASE_POLICY

_PLACE = ("scene", "trace", "hardware", "budget_ms", "draw", "seed")
_FATE = ("status", "reason", "frame", "frames")
_HTML_ROWS = 20


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class StudyResults:
    """A row a run: its place on the axes, its fate, and its metrics.

    Attributes
    ----------
    name : str
        What the study is called.
    rows : pa.Table
        See `to_table`.
    runs : int
        Of the study, done or not.
    """

    name: str
    rows: pa.Table
    runs: int

    def __len__(self) -> int:
        """Return the number of runs that are done."""
        return len(self.rows)

    def __repr__(self) -> str:
        done = count_text(self.runs, "run")
        done = f"{len(self):,} of {done}" if len(self) < self.runs else done
        counts = ", ".join(f"{count:,} {status}" for status, count in self.counts.items())
        return f"<StudyResults {self.name}: {done}, {counts}>"

    @property
    def axes(self) -> list[str]:
        """Columns that tell runs apart."""
        names = self.rows.column_names
        return names[: names.index("label")]

    @property
    def counts(self) -> dict[str, int]:
        """Number of runs by status: ok, failed, not-applicable."""
        statuses: list[Any] = self.rows.column("status").to_pylist()
        counts = Counter(statuses)
        return {name: counts[name] for name in ("ok", "failed", "not-applicable")}

    def to_table(self) -> pa.Table:
        """Return a row a run, in the order of the study.

        Columns are its axes (``policy`` without the parameters that vary, which have columns of
        their own), ``label``, ``status``, ``reason``, ``frame`` of the failure, ``frames``
        replayed, each metric, null where there is no value, and the ``digest`` of the run.
        """
        return self.rows

    def _repr_html_(self) -> str:
        names = [*self.axes, "status", *SHOWN]
        rows = self.rows.select(names).slice(0, _HTML_ROWS).to_pylist()
        return html_table(repr(self)[1:-1], names, ([*row.values()] for row in rows))


def read_study_results(folder: Path) -> StudyResults:
    """Read a folder of results, finished or not.

    Raises `InputError` if it holds none, or a part is damaged.
    """
    manifest = read_manifest(folder)
    if manifest is None or not manifest.parts:
        message = "expected the results of a study, got none; name a folder that `sweep` wrote"
        raise InputError(message, path=folder)
    shown = _readable(column_names(folder, manifest.parts[0]))
    parts = [read_part(folder, part, list(shown.values())) for part in manifest.parts]
    return StudyResults(folder.name, _renamed(pa.concat_tables(parts), shown), manifest.runs)


def results_of(name: str, rows: pa.Table) -> StudyResults:
    """Return the results of a study from the rows that a folder would hold."""
    return StudyResults(name, _renamed(rows, _readable(rows.column_names)), len(rows))


def _readable(names: list[str]) -> dict[str, str]:
    """Return which columns a reader is shown, in order: by the name shown, the one that is stored.

    Parameters
    ----------
    names
        Of the columns of a study's results.
    """
    known = {*schema_of({}).names, BASE_POLICY}
    own = [name for name in names if name not in known]
    policy = {"policy": BASE_POLICY if BASE_POLICY in names else "policy"}
    label = {"label": "policy"}
    metrics = [metric.id for metric in METRICS if metric.id in names]
    before, behind = [*own, *_PLACE], [*_FATE, *metrics, "digest"]
    return policy | {name: name for name in before} | label | {name: name for name in behind}


def _renamed(rows: pa.Table, shown: dict[str, str]) -> pa.Table:
    return pa.table({name: rows.column(stored) for name, stored in shown.items()})
