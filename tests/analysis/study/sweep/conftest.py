"""Results of studies whose numbers are made up, so that every answer is known."""

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.results.manifest import PARTS, Manifest, write_manifest
from lodbench.analysis.study.results.parts import FINAL, write_part
from lodbench.analysis.study.results.record import Entry, encode
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.study import Study

Outcome = Mapping[str, float | None] | Failure
MakeUp = Callable[[Study, Callable[[dict[str, object]], Outcome]], Path]


@pytest.fixture
def make_up(tmp_path: Path, made_scored: Callable[..., Scored]) -> MakeUp:
    """Return what writes a folder of results: metrics or a failure by the cells of each run."""

    def write(study: Study, outcome_of: Callable[[dict[str, object]], Outcome]) -> Path:
        folder = tmp_path / "results"
        (folder / PARTS).mkdir(parents=True)
        runs = study.run_list()
        entries: list[Entry] = []
        for at, case in enumerate(study.cases()):
            found = outcome_of(dict(case.cells))
            if not isinstance(found, Failure):
                values = dict.fromkeys((metric.id for metric in METRICS), None) | dict(found)
                found = made_scored(**values)
            entries.append(Entry(at, found))
        rows = encode(runs, entries)
        half = len(entries) // 2
        parts = [
            write_part(folder, FINAL, number, part)
            for number, part in enumerate((rows.slice(0, half), rows.slice(half)))
        ]
        write_manifest(folder, Manifest(runs.digest, len(runs), complete=True, parts=tuple(parts)))
        return folder

    return write
