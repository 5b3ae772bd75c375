"""The commands `sweep` and `sweep show`, as a user types them."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.results.store import read_results
from lodbench.cli.main import run

STUDY = """\
policies = ["static-screen", "erikson", "mine.py:Broken"]
traces = ["walk"]
budget_ms = [4, 8]
seeds = 2
seconds = "0:2"
"""

BROKEN = """
from lodbench import Capabilities, Selection
import numpy as np

class Broken:
    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        self.budget_ms = budget_ms

    def select(self, view):
        bad = view.frame == 35 and self.budget_ms == 4
        return Selection(view.ids, np.full(len(view), np.nan if bad else 0.0))
"""


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the file of a study of which some runs fail and some do not apply."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(BROKEN, encoding="utf-8")
    path = tmp_path / "small.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def document(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """Return the one JSON document that was printed."""
    return json.loads(capsys.readouterr().out)


def test_a_study_is_carried_out(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every run has a row in the folder of the file's name; a failed one ends with 1, and is told.

    By hand: three policies under two budgets and two seeds; one fails under one of the budgets,
    and one needs a tree.
    """
    assert run(["sweep", "small.toml", "--json"]) == 1
    told = document(capsys)
    assert told["schema"] == "lodbench.sweep/1"
    assert [told[key] for key in ("runs", "ok", "failed", "not_applicable")] == [12, 6, 2, 4]
    assert told["out"] == "small"
    assert [(one["policy"], one["status"], one["frame"]) for one in told["unscored"]] == [
        ("mine.py:Broken", "failed", 35), ("erikson", "not-applicable", None),
    ]  # fmt: skip
    assert told["axes"]["budget_ms"] == [4, 8]
    rows = read_results(Path("small"))
    assert rows.column("status").to_pylist().count("ok") == 6
    assert sorted(path.name for path in study.parent.iterdir()) == [
        "mine.py",
        "small",
        "small.toml",
    ]


def test_a_finished_study_is_not_repeated(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The second time no part is written anew, and the same is told; another study is refused."""
    study.write_text('policies = "full"\nseconds = "0:2"\n', encoding="utf-8")
    assert run(["sweep", "small.toml", "--out", "out/a"]) == 0
    first = capsys.readouterr().out
    assert "small: 1 run, 1 ok\n" in first
    first_frames = read_results(Path("out/a")).column("frames").to_pylist()
    before = {path: path.stat().st_mtime_ns for path in Path("out/a").rglob("*")}
    assert run(["sweep", "--out", "out/a", "small.toml", "--scheduler", "nonsense"]) == 2
    assert "expected an address such as tcp://HOST:8786" in capsys.readouterr().err
    assert run(["sweep", "--out", "out/a", "small.toml"]) == 0
    assert capsys.readouterr().out == first
    assert {path: path.stat().st_mtime_ns for path in Path("out/a").rglob("*")} == before
    study.write_text('policies = "full"\nseconds = "0:1.5"\n', encoding="utf-8")
    assert run(["sweep", "small.toml", "--out", "out/a"]) == 2
    refused = capsys.readouterr().err
    assert "expected a new folder or results of this study, got another study's" in refused
    assert len(read_results(Path("out/a"))) == 1
    assert run(["sweep", "small.toml", "--out", "out/a", "--overwrite"]) == 0
    assert read_results(Path("out/a")).column("frames").to_pylist() != first_frames


def test_somebody_elses_folder_is_left_alone(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is refused before anything runs, also with --overwrite."""
    Path("small").mkdir()
    Path("small/thesis.tex").write_text("x", encoding="utf-8")
    assert run(["sweep", "small.toml", "--overwrite"]) == 2
    assert "got one that holds thesis.tex" in capsys.readouterr().err
    assert [path.name for path in Path("small").iterdir()] == ["thesis.tex"]


def test_a_dry_run_writes_nothing(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It says how many runs there are, and that time and disk are from a sample of three kinds."""
    before = sorted(study.parent.rglob("*"))
    assert run(["sweep", "small.toml", "--dry-run", "--workers", "2", "--json"]) == 0
    told = document(capsys)
    assert [told[key] for key in ("runs", "sampled", "kinds", "workers")] == [12, 3, 3, 2]
    assert told["time_s"] > 0
    assert told["disk_bytes"] > 12 * 8 * 10
    assert run(["sweep", "small.toml", "--dry-run"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("small: 12 runs (policy 3, scene 1, trace 1, hardware 1, budget_ms 2, ")
    assert "from a timed sample of 3 runs" in text
    assert sorted(study.parent.rglob("*")) == before


@pytest.mark.parametrize(
    ("text", "arguments", "refused"),
    [
        ('policies = "full"', ["--workers", "-1"], "workers: expected a whole number >= 0, got -1"),
        ('policies = "full"\n[[exclude]]\npolicy = "full"', [], "got none but excluded ones"),
    ],
)
def test_what_cannot_be_sampled_is_refused(
    study: Path, capsys: pytest.CaptureFixture[str], text: str, arguments: list[str], refused: str
) -> None:
    """A dry run neither waits for workers that never come nor divides by runs that are not."""
    study.write_text(f"{text}\n", encoding="utf-8")
    assert run(["sweep", "small.toml", "--dry-run", *arguments]) == 2
    assert refused in capsys.readouterr().err


def test_show_in_every_form(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Tables tell who has no scores; pasted forms have only themselves on stdout."""
    run(["sweep", "small.toml"])
    capsys.readouterr()
    assert run(["sweep", "show", "small"]) == 0
    listed = capsys.readouterr().out
    assert "mine.py:Broken: 2 runs failed: frame 35: detail" in listed
    assert "erikson: 4 runs not applicable: the scene is flat" in listed
    asked = ["sweep", "show", "small", "--pivot", "policy,budget_ms", "--metric", "sse_px_p95"]
    assert run([*asked, "--where", "policy <> 'erikson'"]) == 0
    assert "budget_ms=4" in capsys.readouterr().out
    assert run([*asked, "--csv"]) == 0
    shown = capsys.readouterr()
    rows = list(csv.DictReader(io.StringIO(shown.out)))
    assert [(row["policy"], row["ok"], row["failed"], row["not_applicable"]) for row in rows] == [
        ("static-screen", "2", "0", "0"), ("static-screen", "2", "0", "0"),
        ("erikson", "0", "0", "2"), ("erikson", "0", "0", "2"),
        ("mine.py:Broken", "0", "2", "0"), ("mine.py:Broken", "2", "0", "0"),
    ]  # fmt: skip
    assert "2 runs failed" in shown.err
    assert run([*asked, "--latex"]) == 0
    assert r"\begin{tabular}{lrr}" in capsys.readouterr().out
    assert run([*asked, "--json"]) == 0
    told = document(capsys)
    assert told["schema"] == "lodbench.sweep-show/1"
    assert [row["sse_px_p95_runs"] for row in told["pivot"]] == [2, 2, 0, 0, 0, 2]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["show", "nowhere"], "nowhere: expected the results of a study, got none"),
        (["show", "nowhere", "--csv", "--json"], "expected one of them, got more"),
        (["nowhere.toml"], "nowhere.toml"),
        (["small.toml", "--policy-memory", "lots"], "expected bytes such as 2GB"),
        (["small.toml", "--out", "."], "expected a folder of its own to write to"),
    ],
)
def test_wrong_usage_is_one_line(
    study: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing runs, nothing is written, and the exit code is 2."""
    before = sorted(study.parent.rglob("*"))
    assert run(["sweep", *arguments]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert said in shown.err
    assert shown.err.count("\n") == 1
    assert sorted(study.parent.rglob("*")) == before


@pytest.mark.slow
def test_a_stopped_study_goes_on(study: Path) -> None:
    """Stopped by a signal, it says how to go on, and ends with the bytes of one that was not."""
    text = 'policies = ["full", "static-screen"]\ntraces = "walk"\nseconds = "0:2"\nseeds = 40\n'
    study.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "lodbench", "sweep", "small.toml", "--out"]
    process = subprocess.Popen([*command, "stopped"], stderr=subprocess.PIPE, text=True)
    while not list(Path("stopped/parts").glob("*.parquet")) and process.poll() is None:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGTERM)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 143
    assert "of 80 runs are in stopped; run the same command again to go on" in said
    for name in ("stopped", "whole"):
        assert subprocess.run([*command, name]).returncode == 0
    parts = [
        {
            path.name: path.read_bytes()
            for path in Path(name).rglob("*")
            if path.name != "run-info.json" and path.is_file()
        }
        for name in ("stopped", "whole")
    ]
    assert parts[0] == parts[1]
