"""A hundred thousand runs are asked in a laptop's memory."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.results.manifest import PARTS, Manifest, Part, write_manifest
from lodbench.analysis.study.results.parts import FINAL, write_part
from lodbench.analysis.study.results.record import Entry, encode
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.study import Study

ASK = """
import resource, sys
from lodbench.cli.main import run
code = run(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)
sys.exit(code)
"""
PARTS_OF = 100
"""Parts, of 1,000 runs each."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, made_scored: Callable[..., Scored]) -> Path:
    """Return 100,000 runs: five policies, ten budgets, two paths and 1,000 seeds."""
    folder = tmp_path_factory.mktemp("large")
    (folder / PARTS).mkdir()
    policies = ["full", "zach", "feedback", "hoppe", "lodmanager"]
    study = Study(policies, traces=["tour", "walk"], budget_ms=list(range(4, 14)), seeds=10)
    runs, rng = study.run_list(), np.random.default_rng(0)
    parts: list[Part] = []
    for number in range(PARTS_OF):
        values = rng.random((len(runs), len(METRICS)))
        entries = [
            Entry(at, made_scored(**dict(zip((m.id for m in METRICS), row, strict=True))))
            for at, row in enumerate(values.tolist())
        ]
        rows = encode(runs, entries)
        seeds = np.array(rows.column("seed").to_pylist()) + 10 * number
        rows = rows.set_column(rows.column_names.index("seed"), "seed", pa.array(seeds))
        parts.append(write_part(folder, FINAL, number, rows))
    count = PARTS_OF * len(runs)
    write_manifest(folder, Manifest(runs.digest, count, complete=True, parts=tuple(parts)))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(
    ("question", "rows"),
    [
        (["--pivot", "policy,budget_ms"], 50),
        (["--where", "budget_ms < 9 and seed >= 500"], 25_000),
        ([], 100_000),
        (["--sensitivity", "--metric", "work_ms_p95"], 5),
    ],
)
def test_large_results_are_asked_within_a_gigabyte(
    folder: Path, question: list[str], rows: int
) -> None:
    """Lists, means and shares of 100,000 runs each have all their rows, in less than 1 GB."""
    command = [sys.executable, "-c", ASK, "sweep", "show", str(folder), "--json", *question]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    record = json.loads(ended.stdout)
    (answer,) = (record[kind] for kind in ("list", "pivot", "sensitivity") if kind in record)
    assert len(answer) == rows
    assert int(ended.stderr) * 1024 < 1e9
