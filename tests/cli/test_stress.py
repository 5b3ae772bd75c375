"""`lodbench stress` saves a path that `lodbench check` then guards."""

import json
from pathlib import Path

import pytest

from lodbench.cli.main import run
from lodbench.traces.cameras.read_trace import read_trace

QUICK = ["--evaluations", "8", "--duration-s", "1.6", "--legs", "2"]


@pytest.mark.slow
def test_a_path_becomes_a_regression_test(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The commands that are printed accept the path, and pass as long as nothing changes."""
    out = tmp_path / "worst.csv"
    assert run(["stress", "feedback", *QUICK, "--out", str(out), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["schema"] == "lodbench.stress/1"
    assert record["value"] > 0.0
    assert read_trace(str(out)).duration_s == 1.6
    check = [*record["check"][1:], "--workers", "1", "--seeds", "2"]
    assert run([*check, "--update-baseline"]) == 0
    assert run([*check, "--strict"]) == 0
    assert "passes: feedback in plaza on stress: work_ms_p99" in capsys.readouterr().out


@pytest.mark.slow
def test_text_says_what_was_found(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Badness of the path and of the walk stand side by side."""
    out = tmp_path / "worst.csv"
    assert run(["stress", "full", *QUICK, "--badness", "lag", "--out", str(out)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("lag ")
    assert lines[0].endswith("on the bundled walk")
    assert lines[1] == f"path: {out}"
    assert {path.name for path in tmp_path.iterdir()} == {"worst.csv", "worst.limits.toml"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["feedbak"], "did you mean feedback?"),
        (["feedback", "--badness", "speed"], "expected overshoot, toggles, lag"),
        (["feedback", "--out", "worst.xyz"], "expected a name that ends in"),
        (["feedback", "--legs", "0"], "legs: expected 1 to 100"),
        (["feedback", "--scene", "plazza"], "did you mean plaza?"),
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
    assert run(["stress", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert message in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
