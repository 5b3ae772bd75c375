"""Studies of many runs: time grows with their number, and 100,000 of them fit into 1 GB."""

import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from lodbench.analysis.study.engine.task import Outcome
from lodbench.analysis.study.results.run_list import RunList
from lodbench.analysis.study.results.store import ResultStore, read_results

MakeRuns = Callable[..., RunList]


def fill(folder: Path, runs: RunList, make_outcome: Callable[..., Outcome]) -> None:
    """Carry out half of a study."""
    outcomes = [make_outcome(at) for at in range(50)]
    with ResultStore.open(folder, runs) as store:
        for at in range(0, len(runs), 2):
            store.add(at, outcomes[at % 50])


def resume(folder: Path, make: Callable[[], RunList]) -> tuple[RunList, Any]:
    """List a study, find what is missing of it, and read what is there."""
    runs = make()
    with ResultStore.open(folder, runs) as store:
        assert len(store.missing) == len(runs) // 2
    return runs, read_results(folder)


@pytest.mark.slow
def test_resuming_takes_time_and_memory_in_proportion(
    make_runs: MakeRuns, make_outcome: Callable[..., Outcome], tmp_path: Path
) -> None:
    """Eight times the runs take at most sixteen times as long, and a run at most 10 kB."""
    taken: list[float] = []
    for count in (1_000, 8_000):
        folder = tmp_path / str(count)
        fill(folder, make_runs(count), make_outcome)
        begin = time.process_time()
        resume(folder, lambda count=count: make_runs(count))
        taken.append(time.process_time() - begin)
    assert taken[1] < 16.0 * taken[0]
    tracemalloc.start()
    arrow_bytes = pa.total_allocated_bytes()
    runs, table = resume(tmp_path / "8000", lambda: make_runs(8_000))
    arrow_bytes = pa.total_allocated_bytes() - arrow_bytes
    _, python_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(table) == 4_000
    assert (python_bytes + arrow_bytes) / len(runs) < 10_000
