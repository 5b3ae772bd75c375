"""Export: a run read back from the viewers' formats has the same metrics."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import DisplayMode
from lodbench.sim.export.export import EXPORTS, frame_timings
from lodbench.sim.frame_log import TIMES, FrameLog
from lodbench.traces.logs.formats.capframex import read_capframex
from lodbench.traces.logs.formats.presentmon import read_presentmon
from lodbench.traces.logs.timings import FloatArray, FrameTimings

Replay = Callable[..., FrameLog]
MODES: tuple[DisplayMode, ...] = get_args(DisplayMode)
READERS = {"presentmon": read_presentmon, "capframex": read_capframex}
NS_IN_MS = 1e-6
ROUNDING_MS = 2 * NS_IN_MS
"""PresentMon is written to the nanosecond; a latency is the sum of two columns."""


def exported(log: FrameLog, name: str, folder: Path) -> FrameTimings:
    """Return what our reader of a format reads of a run exported to it."""
    path = folder / f"run{EXPORTS[name].suffix}"
    EXPORTS[name].write(log, path)
    return READERS[name](path)


def summary(values: FloatArray) -> dict[str, float]:
    """Return statistics and the three 1 % lows of the values that there are, worked out plainly."""
    x = np.sort(values[np.isfinite(values)])[::-1]
    slow = x[x >= np.percentile(x, 99.0, method="median_unbiased")]
    reached = int(np.argmax(np.cumsum(x) >= 0.01 * x.sum()))
    return {
        "count": len(x),
        "mean": float(np.mean(x)),
        "sd": float(np.std(x, ddof=1)),
        "p99": float(np.percentile(x, 99.0)),
        "max": float(x[0]),
        "low1_percentile": float(np.percentile(x, 99.0)),
        "low1_mean": float(np.mean(slow)),
        "low1_integral": float(x[reached]),
    }


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("mode", MODES)
def test_metrics_survive(
    tmp_path: Path, mode: DisplayMode, name: str, run_pipeline: Replay
) -> None:
    """Frame times, 1 % lows, lag, animation error, drops, CPU and GPU are those of the run."""
    log = run_pipeline(mode)
    run = MeasuredFrames(log, 1e-9 * log["input_ns"][1])  # the first frame makes no row
    read = exported(log, name, tmp_path)
    assert len(read) == len(log) - 1
    assert np.count_nonzero(read.dropped) == np.count_nonzero(run["display_ns"] < 0)
    assert read.dropped.any() == (mode == "mailbox")
    pairs = {
        "frame_ms": (run.frame_ms, read.between_display_change_ms),
        "lag_ms": (run.lag_ms, read.display_latency_ms),
        "animation_error_ms": (np.abs(run.animation_error_ms), np.abs(read.animation_error_ms)),
        "gpu_ms": (run["gpu_ms"], read.gpu_busy_ms),
        "cpu_ms": (run["cpu_ms"], read.cpu_busy_ms),
        "work_ms": (run.work_ms, np.fmax(read.cpu_busy_ms, read.gpu_busy_ms)),
    }
    for metric, (simulated, measured) in pairs.items():
        assert measured == pytest.approx(simulated, abs=ROUNDING_MS, nan_ok=True), metric
        assert summary(measured) == pytest.approx(summary(simulated), abs=ROUNDING_MS), metric


@pytest.mark.parametrize("mode", MODES)
def test_columns_follow_the_definitions(
    tmp_path: Path, mode: DisplayMode, run_pipeline: Replay
) -> None:
    """Each column of PresentMon is its definition in terms of the pipeline's times."""
    log = run_pipeline(mode)
    times = {name: log[name] * 1.0 for name in TIMES}
    times["display_ns"][times["display_ns"] < 0] = np.nan
    start, present, gpu_start, gpu_end, screen = (times[name] for name in TIMES)
    read = exported(log, "presentmon", tmp_path)
    following = np.append(start[1:], np.nan)
    expected = {
        "between_presents_ms": np.diff(present, prepend=0),
        "frame_ms": following - start,
        "cpu_busy_ms": present - start,
        "in_present_ms": following - present,
        "gpu_latency_ms": gpu_start - start,
        "gpu_time_ms": gpu_end - gpu_start,
        "until_render_complete_ms": gpu_end - present,
        "until_displayed_ms": screen - present,
    }
    for name, values_ns in expected.items():
        measured = getattr(read, name)
        assert measured == pytest.approx(values_ns[1:] * NS_IN_MS, abs=ROUNDING_MS, nan_ok=True), (
            name
        )
    assert read.present_s == pytest.approx(present[1:] / 1e9, abs=1e-12)
    assert read.cpu_start_s == pytest.approx(start[1:] / 1e9, abs=1e-11)


def test_hand_worked_run(run_pipeline: Replay) -> None:
    """Three frames: the second shown 11 ms after its input and moved 2 ms too little."""
    log = run_pipeline("immediate", frames=3)
    rows = [
        [0, 4_000_000, 4_000_000, 9_000_000, 9_000_000],
        [5_000_000, 8_000_000, 9_000_000, 16_000_000, 16_000_000],
        [10_000_000, 16_000_000, 16_000_000, 20_000_000, -1],
    ]
    timings = frame_timings(FrameLog(log.header, np.array(rows), log.counts.copy()))
    nan = float("nan")
    assert timings.application == "lodbench-feedback-gain-0.5-delay-2"
    assert timings.dropped.tolist() == [False, True]
    assert timings.between_presents_ms.tolist() == [4, 8]
    assert timings.frame_ms == pytest.approx([5, nan], nan_ok=True)
    assert timings.in_present_ms == pytest.approx([2, nan], nan_ok=True)
    assert timings.display_latency_ms == pytest.approx([11, nan], nan_ok=True)
    assert timings.between_display_change_ms == pytest.approx([7, nan], nan_ok=True)
    assert timings.animation_error_ms == pytest.approx([-2, nan], nan_ok=True)
    assert np.isnan(timings.input_to_photon_ms).all()


def test_a_single_frame_is_refused(run_pipeline: Replay) -> None:
    """One frame has no present before it, so there would be no row."""
    with pytest.raises(InputError, match="expected a run of at least 2 frames, got 1"):
        frame_timings(run_pipeline("vsync", frames=1))


@pytest.mark.parametrize("name", EXPORTS)
def test_same_run_same_bytes(tmp_path: Path, name: str, run_pipeline: Replay) -> None:
    """An export depends on nothing but the run."""
    log = run_pipeline("mailbox", frames=50)
    for copy in ("a", "b"):
        EXPORTS[name].write(log, tmp_path / copy)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_viewers_that_split_at_commas_see_whole_columns(
    tmp_path: Path, run_pipeline: Replay
) -> None:
    """The policy's parameters put no comma or quote into a row."""
    EXPORTS["presentmon"].write(run_pipeline("vsync", frames=20), tmp_path / "out.csv")
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert {line.count(",") for line in lines} == {27}
    assert not re.search(r'["\s]', lines[1].replace("Other", ""))
