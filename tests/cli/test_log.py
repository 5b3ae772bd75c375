"""`lodbench log`: what it prints and writes, and `fit --join` and `--lag` beside it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.cli.main import run


def write_capture(path: Path, seed: int = 0, frames: int = 200, scale: float = 1.0) -> Path:
    """Write a capture with a clock, frame and GPU times, and a column that serves nothing."""
    rng = np.random.default_rng(seed)
    frame_ms = scale * rng.gamma(60.0, 0.2, frames)
    clock = np.cumsum(frame_ms) / 1e3
    rows = [
        f"{t:.6f},{f:.5f},{0.8 * f:.5f},{0.3 * f:.5f},7"
        for t, f in zip(clock, frame_ms, strict=True)
    ]
    lines = ["time_s,frame_ms,gpu_ms,cpu_ms,physics_ms", *rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_info_prints_columns_metrics_chart_and_warnings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """What is not used is told, and the median stands in words above all."""
    assert run(["log", "info", str(write_capture(tmp_path / "walk.csv"))]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    for part in (
        "walk: csv, 200 frames",
        "the median frame takes",
        "fps_low1_integral",
        "by neither",
        "slowest",
        "not used though the name smells of a time: physics_ms",
    ):
        assert part in printed


def test_info_is_one_document_and_one_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """JSON has schema and metrics; the page is written whole."""
    log, page = write_capture(tmp_path / "walk.csv"), tmp_path / "walk.html"
    assert run(["log", "info", str(log), "--json", "--html", str(page)]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert record["schema"] == "lodbench.log-info/2"
    assert record["unused"] == ["physics_ms"]
    assert record["bound"] == {"gpu": 0.0, "cpu": 0.0, "neither": 1.0}
    assert "<html" in page.read_text("utf-8")


def test_compare_prints_differences_with_intervals(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """B is a fifth slower than A, and the method of the intervals is named."""
    monkeypatch.setattr("lodbench.analysis.captures.capture_compare.DRAWS", 60)
    logs = [
        str(write_capture(tmp_path / "a.csv", 1)),
        str(write_capture(tmp_path / "b.csv", 2, scale=1.2)),
    ]
    assert run(["log", "compare", *logs, "--json"]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert record["schema"] == "lodbench.log-compare/2"
    low, high = record["metrics"]["frame_ms_mean"]["interval"]
    assert low < 2.4 < high
    assert record["metrics"]["gpu_ms_mean"]["differs"]
    assert run(["log", "compare", *logs]) == 0
    assert "block bootstrap" in capsys.readouterr().out


def write_joined(folder: Path) -> tuple[Path, Path]:
    """Write a PresentMon capture, and the engine's counts: 2 ms and 3 ns a triangle."""
    rng = np.random.default_rng(3)
    triangles = rng.integers(200_000, 3_000_000, 300)
    gpu_ms = 2.0 + 3e-6 * triangles + 0.05 * rng.standard_normal(300)
    clock = np.cumsum(gpu_ms + 1.0) / 1e3
    names = "Application,ProcessID,SwapChainAddress,Dropped,TimeInSeconds,msBetweenPresents"
    rows = [
        f"a.exe,1,0x1,0,{t:.6f},{g + 1.0:.4f},{g:.4f}" for t, g in zip(clock, gpu_ms, strict=True)
    ]
    capture, counts = folder / "pm.csv", folder / "counters.csv"
    capture.write_text("\n".join([f"{names},msGPUActive", *rows]) + "\n", encoding="utf-8")
    lines = [f"{t:.6f},{n}" for t, n in zip(clock[20:], triangles[20:], strict=True)]
    counts.write_text("\n".join(["time_s,triangles", *lines]) + "\n", encoding="utf-8")
    return capture, counts


QUICK = ["--steps", "400", "--heldout", "none", "--json"]


def test_counts_of_another_log_are_joined_by_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """PresentMon's times with the engine's triangles give the cost of a triangle."""
    capture, counts = write_joined(tmp_path)
    assert run(["fit", str(capture), "--join", str(counts), *QUICK]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert record["coefficients"]["triangles"]["mean"] == pytest.approx(3.0, rel=0.03)
    assert any("280 of 280 rows" in note for note in record["logs"][0]["notes"])
    assert run(["fit", str(capture), str(capture), "--join", str(counts), *QUICK]) == 2
    assert "--join: expected one LOG" in capsys.readouterr().err


def test_a_late_timer_is_shifted_back_and_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Auto finds two frames; a number is taken as it is; anything else is refused."""
    rng = np.random.default_rng(6)
    triangles = rng.integers(200_000, 3_000_000, 300)
    gpu_ms = np.concatenate(([0.0, 0.0], 1.0 + 2e-6 * triangles[:-2]))
    path = tmp_path / "late.csv"
    rows = [f"{g:.5f},{n}" for g, n in zip(gpu_ms, triangles, strict=True)]
    path.write_text("\n".join(["gpu_ms,triangles", *rows]) + "\n", encoding="utf-8")
    assert run(["fit", str(path), *QUICK]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert record["lag_frames"] == [2]
    assert any("late by 2 frames" in finding for finding in record["findings"])
    assert record["coefficients"]["triangles"]["mean"] == pytest.approx(2.0, rel=0.02)
    assert run(["fit", str(path), *QUICK, "--lag", "2"]) == 0
    assert json.loads(capsys.readouterr().out)["lag_frames"] == [2]
    assert run(["fit", str(path), *QUICK, "--lag", "soon"]) == 2
    assert "--lag: expected auto or a number" in capsys.readouterr().err


def test_a_name_is_mapped_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Two columns for one name leave open which is meant."""
    log = write_capture(tmp_path / "walk.csv")
    assert run(["log", "info", str(log), "--map", "gpu_ms=cpu_ms,gpu_ms=frame_ms"]) == 2
    assert "--map: expected each name once" in capsys.readouterr().err
