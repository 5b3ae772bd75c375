"""What a capture holds: by hand, and by the tools' definitions; how two differ, with coverage."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.captures.capture_compare import block_frames, compare_captures
from lodbench.analysis.captures.capture_frames import bound_shares, score
from lodbench.analysis.captures.capture_info import capture_record
from lodbench.analysis.captures.capture_page import render_capture
from lodbench.analysis.captures.capture_table import chart
from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.traces.logs.render_log import RenderLog


def log_of(
    frame_ms: FloatArray, gpu_ms: FloatArray | None = None, cpu_ms: FloatArray | None = None
) -> RenderLog:
    """Make a capture of frame times."""
    return RenderLog("run", "csv", (), np.empty((len(frame_ms), 0)), frame_ms, gpu_ms, cpu_ms)


def test_a_capture_of_a_hundred_frames_worked_by_hand():
    """98 frames of 10 ms, one of 20 and one of 80: each metric from its definition."""
    frame_ms = np.full(100, 10.0)
    frame_ms[40], frame_ms[70] = 20.0, 80.0
    scores = score(frame_ms)
    assert scores["average_fps"] == pytest.approx(1e5 / 1_080.0)
    assert scores["frame_ms_mean"] == pytest.approx(10.8)
    assert scores["frame_ms_p50"] == pytest.approx(10.0)
    # Type 7: 0.99 * 99 = 98.01, just above the second longest, of 20 ms.
    assert scores["frame_ms_p99"] == pytest.approx(20.0 + 0.01 * 60.0)
    assert scores["fps_low1_percentile"] == pytest.approx(1e3 / 20.6)
    assert scores["fps_low1_mean"] == pytest.approx(1e3 / 80.0)
    assert scores["fps_low1_integral"] == pytest.approx(1e3 / 80.0)  # 1 % of 1,080 ms is 10.8
    assert scores["hitches_per_min"] == pytest.approx(60e3 / 1_080.0)
    assert scores["stutter_time_fraction"] == pytest.approx(80.0 / 1_080.0)


def test_metrics_are_those_of_numpy_on_any_times():
    """Mean, deviation and percentiles agree with numpy's to the nanosecond of the clock."""
    frame_ms = np.random.default_rng(1).gamma(9.0, 1.7, 2_000)
    scores = score(frame_ms)
    assert scores["frame_ms_sd"] == pytest.approx(frame_ms.std(ddof=1), abs=1e-5)
    for q in (50, 95, 99):
        assert scores[f"frame_ms_p{q}"] == pytest.approx(np.percentile(frame_ms, q), abs=1e-5)


def test_who_binds_a_frame():
    """By time: 40 ms of GPU-bound frames, 20 of CPU-bound ones, 20 in which both wait."""
    log = log_of(
        np.array([20.0, 20.0, 20.0, 20.0]),
        gpu_ms=np.array([19.0, 18.5, 5.0, 5.0]),
        cpu_ms=np.array([5.0, 18.2, 19.9, 6.0]),
    )
    assert bound_shares(log) == pytest.approx({"gpu": 0.5, "cpu": 0.25, "neither": 0.25})
    assert bound_shares(log_of(np.array([20.0]))) is None


def test_the_record_tells_columns_findings_and_the_median_in_words():
    """A capped capture says so, and its median is a sentence."""
    record = capture_record(log_of(np.tile([1e3 / 60, 2e3 / 60], 100)))
    assert record["schema"] == "lodbench.log-info/2"
    assert record["median_frame"] == "the median frame takes 25 ms, 40 a second"
    assert [finding["kind"] for finding in record["findings"]] == ["capped"]
    assert record["columns"][0]["missing"] == 0


def test_the_chart_shows_the_slow_stretch():
    """A hitch in the last third stands out in the line of the slowest frames alone."""
    frame_ms = np.full(720, 10.0)
    frame_ms[600] = 40.0
    slowest, median, scale = chart(frame_ms, 72)
    assert slowest.index("█") >= 0
    assert len(slowest) == len(median) == 8 + 1 + 72
    assert "720 frames" in scale


def test_the_page_is_one_file_and_the_same_each_time():
    """The same record gives the same bytes; a capture without frame times has a page too."""
    frame_ms = np.random.default_rng(2).gamma(9.0, 1.7, 200)
    record = capture_record(log_of(frame_ms))
    page = render_capture(record, {"frames": frame_ms})
    assert page == render_capture(record, {"frames": frame_ms})
    assert "the median frame takes" in page
    gpu = RenderLog("gpu", "csv", (), np.empty((3, 0)), gpu_ms=np.array([1.0, 2.0, 3.0]))
    assert "GPU" in render_capture(capture_record(gpu), {})


def alike(rng: np.random.Generator, frames: int, mean_ms: float) -> FloatArray:
    """Draw frame times whose neighbours are alike: autoregressive, with a memory of 20 frames."""
    noise = rng.normal(0.0, 1.0, frames + 200)
    values = np.empty_like(noise)
    values[0] = noise[0]
    for place in range(1, len(noise)):
        values[place] = 0.95 * values[place - 1] + noise[place]
    return mean_ms + 0.5 * values[200:]


@pytest.fixture
def few_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw 60 captures in place of 500."""
    monkeypatch.setattr("lodbench.analysis.captures.capture_compare.DRAWS", 60)


@pytest.mark.usefixtures("few_draws")
def test_equal_captures_do_not_differ_and_slower_ones_do():
    """The sign is that of B minus A, and a difference of 20 % is seen."""
    rng = np.random.default_rng(3)
    one, other = (log_of(alike(rng, 1_500, 12.0)) for _ in range(2))
    record = compare_captures(one, other)
    assert not record["metrics"]["frame_ms_mean"]["differs"]
    slower = compare_captures(one, log_of(alike(rng, 1_500, 14.4)))["metrics"]["frame_ms_mean"]
    assert slower["differs"]
    assert slower["difference"] == pytest.approx(2.4, abs=0.6)
    assert slower["interval"][0] < 2.4 < slower["interval"][1]


@pytest.mark.usefixtures("few_draws")
def test_the_same_seed_gives_the_same_intervals():
    """Two calls agree; another seed moves the interval a little."""
    rng = np.random.default_rng(4)
    one, other = (log_of(alike(rng, 400, 12.0)) for _ in range(2))
    assert compare_captures(one, other) == compare_captures(one, other)
    assert compare_captures(one, other, 1) != compare_captures(one, other)


def test_blocks_are_of_two_seconds_and_ten_at_least():
    """Of 16 ms 125 frames; of a capture of 300 frames, 30."""
    assert block_frames(np.full(6_000, 16.0)) == 125
    assert block_frames(np.full(300, 1e3 / 60)) == 30


def test_captures_that_cannot_be_compared_are_refused():
    """Too short, or without frame times."""
    short = log_of(np.full(20, 10.0))
    with pytest.raises(InputError, match="expected 30 frames or more, got 20"):
        compare_captures(short, log_of(np.full(100, 10.0)))
    gpu = RenderLog("gpu", "csv", (), np.empty((3, 0)), gpu_ms=np.array([1.0, 2.0, 3.0]))
    with pytest.raises(InputError, match="gpu: expected times from frame to frame"):
        compare_captures(gpu, short)


@pytest.mark.slow
def test_intervals_of_95_percent_cover_the_true_difference(monkeypatch: pytest.MonkeyPatch):
    """Of 100 pairs of captures whose neighbours are alike, at least 89 intervals hold the truth."""

    def means(values: FloatArray) -> dict[str, float]:
        mean_ms = float(values.mean())
        return {"average_fps": 1e3 / mean_ms, "frame_ms_mean": mean_ms}

    monkeypatch.setattr("lodbench.analysis.captures.capture_compare.METRICS", ("frame_ms_mean",))
    monkeypatch.setattr("lodbench.analysis.captures.capture_compare.score", means)
    rng = np.random.default_rng(5)
    covered = 0
    for _ in range(100):
        first, second = (log_of(alike(rng, 1_500, mean)) for mean in (12.0, 12.5))
        low, high = compare_captures(first, second)["metrics"]["frame_ms_mean"]["interval"]
        covered += low <= 0.5 <= high
    assert covered >= 89


def test_a_frame_of_impossible_length_is_no_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """1e308 ms overflow where they are added; numpy says nothing of that beside the table."""
    path = tmp_path / "far.csv"
    head = "Application,ProcessID,SwapChainAddress,Dropped,TimeInSeconds,MsBetweenPresents"
    rows = [f"a.exe,7,0x1,0,{0.016 * i:.4f},1e308" for i in range(40)]
    path.write_text("\n".join([head, *rows, ""]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run(["log", "info", str(path)]) == 0
        assert run(["log", "compare", str(path), str(path)]) in (0, 2)
    assert "Warning" not in capsys.readouterr().err
