"""`lodbench suite` prints a leaderboard, keeps it, and says by its exit code if a policy failed."""

import json
from pathlib import Path

import pytest

from lodbench.analysis.study.suite import definition
from lodbench.analysis.study.suite.definition import Cell, Suite
from lodbench.cli.main import run

TINY = Suite(
    name="tiny",
    version=3,
    policies=("full", "static-screen"),
    cells=(
        Cell("plaza", "walk", "desktop-assumed", 20.0),
        Cell("city", "walk", "desktop-assumed", 20.0),
    ),
    paths=2,
    length_s=1.5,
    seeds=1,
)

FAULTY = """
import numpy as np
from lodbench.policies import Capabilities, Selection

class Faulty:
    capabilities = Capabilities()
    def reset(self, scene, budget_ms): pass
    def select(self, view): return Selection(view.ids, np.full(len(view.ids), np.nan))
"""


@pytest.fixture(autouse=True)
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let there be a suite that is over soon."""
    monkeypatch.setitem(definition.SUITES, "tiny", TINY)


@pytest.mark.slow
def test_the_record_is_printed_and_kept(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A submitted policy that fails makes exit code 1; the document is printed all the same."""
    (tmp_path / "mine.py").write_text(FAULTY, encoding="utf-8")
    mine = f"{tmp_path / 'mine.py'}:Faulty"
    command = ["suite", "tiny", "--submit", mine, "--out", str(tmp_path / "out")]
    assert run([*command, "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert json.loads((tmp_path / "out" / "suite.json").read_text(encoding="utf-8")) == record
    assert next(iter(record)) == "schema"
    assert record["schema"] == "lodbench.suite/1"
    assert (record["suite"], record["suite_version"]) == ("tiny", 3)
    assert record["suite_hash"] == TINY.digest
    flat, tree = record["cells"]
    status = {one["label"]: one["status"] for one in flat["standings"]}
    assert status == {"full": "ok", "static-screen": "ok", mine: "failed"}
    assert {one["status"] for one in tree["standings"]} == {"not-applicable"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "report.html",
        "suite.json",
        *(cell.name for cell in TINY.cells),
    }
    assert record["command"] == f"lodbench suite tiny --submit {mine}"

    assert run(command) == 1
    text = capsys.readouterr().out
    assert "suite tiny, version 3" in text
    assert f"{mine} failed: {TINY.cells[0].name}: frame" in text
    assert "n/a" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["quik"], "did you mean quick?"),
        (["tiny", "--submit", "feedbak"], "did you mean feedback?"),
        (["tiny", "--submit", "full"], "expected each once, got full twice"),
        (["tiny", "--submit", "oracle"], "expected a policy, got an oracle"),
        (["tiny", "--submit", "mine.py:Mine"], "mine.py"),
    ],
)
def test_bad_input(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Exit code 2, one line, and nothing written."""
    monkeypatch.chdir(tmp_path)
    assert run(["suite", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert message in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
