"""`lodbench export`: which run is meant, what is written, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from lodbench.cli.main import run
from lodbench.sim.frame_log import COUNTS, FrameLog, LogHeader
from lodbench.sim.frame_log_file import write_frame_log
from lodbench.traces.logs.formats.capframex import read_capframex
from lodbench.traces.logs.formats.presentmon import read_presentmon


def steady(frames: int, policy: str) -> FrameLog:
    """Return a run at 100 fps in which a frame takes 2 ms on the CPU, then 5 ms on the GPU."""
    steps_ns = np.array([0, 2_000_000, 2_000_000, 7_000_000, 7_000_000])
    times_ns = np.arange(frames)[:, np.newaxis] * 10_000_000 + steps_ns
    header = LogHeader(policy, "scene", "trace", "machine", 10.0, 0, "immediate", 60.0, 1e9)
    return FrameLog(header, times_ns, np.zeros((frames, len(COUNTS))))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return what `compare --out` leaves of two policies, and work in an empty folder beside it."""
    frames = tmp_path / "out" / "frames"
    frames.mkdir(parents=True)
    write_frame_log(frames / "full.parquet", steady(40, "full"))
    write_frame_log(frames / "feedback-gain-0.5.parquet", steady(60, "feedback:gain=0.5"))
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "out"


def test_one_file_is_exported_here(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Without --out, the file is named after the policy's and stands in the current folder."""
    assert run(["export", str(folder / "frames" / "full.parquet"), "--format", "presentmon"]) == 0
    printed = capsys.readouterr().out
    assert printed == "full.presentmon.csv: 40 frames of full, presentmon\n"
    assert len(read_presentmon("full.presentmon.csv")) == 39


@pytest.mark.parametrize("policy", ["feedback:gain=0.5", "feedback-gain-0.5"])
def test_policy_of_a_folder(folder: Path, policy: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A policy is chosen by its name or its file's; --json tells what was written."""
    arguments = ["--policy", policy, "--format", "capframex", "--out", "x.json", "--json"]
    assert run(["export", str(folder), *arguments]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "schema": "lodbench.export/1",
        "run": str(folder / "frames" / "feedback-gain-0.5.parquet"),
        "policy": "feedback:gain=0.5",
        "format": "capframex",
        "out": "x.json",
        "frames": 60,
    }
    assert len(read_capframex("x.json")) == 59


def test_chrome_trace(folder: Path) -> None:
    """The third format is written by its own ending."""
    assert run(["export", str(folder), "--policy", "full", "--format", "chrome-trace"]) == 0
    assert len(json.loads(Path("full.trace.json").read_text())["traceEvents"]) > 40


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{out}", "--format", "csv"], "--format: expected one of presentmon, capframex, chrome-"),
        (["{out}", "--format", "presentmon"], "expected one policy of feedback:gain=0.5, full"),
        (
            ["{out}", "--format", "presentmon", "--policy", "none"],
            "expected one policy of feedback:gain=0.5, full, got none; choose with --policy",
        ),
        (
            ["{out}/frames/full.parquet", "--format", "presentmon", "--policy", "other"],
            "expected a run of policy other, got one of full",
        ),
        (["{out}/frames", "--format", "presentmon"], "expected a folder with frames/POLICY"),
        (["none.parquet", "--format", "presentmon"], "expected a frame log, got no file"),
        (
            ["{out}", "--policy", "full", "--format", "presentmon", "--out", "no/out.csv"],
            "expected a path that can be written",
        ),
    ],
)
def test_bad_input(
    folder: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line on stderr, exit code 2, and nothing written."""
    assert run(["export", *(argument.format(out=folder) for argument in arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: ")
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    assert list(Path().iterdir()) == []
