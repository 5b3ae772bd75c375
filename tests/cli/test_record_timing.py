"""How `lodbench record` times frames: clocks, orders, and frames in flight."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from lodbench.base.files.parquet_file import ParquetColumns
from lodbench.sim.frame_log_file import read_frame_log
from lodbench.traces.logs.read_log import read_render_log

pytestmark = pytest.mark.usefixtures("egl")

STATIC = ["--policy", "static-screen"]
Record = Callable[..., int]


def test_what_the_header_says_of_how_it_was_recorded(record: Record) -> None:
    """Two recordings of one process are one occasion; calibration alone is shuffled."""
    assert record(*STATIC, out="policy.parquet") == 0
    assert record("--calibrate", "--steps", "4", "--clock", "thread", out="log.parquet") == 0
    policy, programme = (
        dict(read_render_log(Path(f"{name}.parquet")).header) for name in ("policy", "log")
    )
    assert (policy["order"], programme["order"]) == ("path", "shuffled")
    assert (policy["clock"], programme["clock"]) == ("wall", "thread")
    assert policy["occasion"] == programme["occasion"]
    assert policy["frames_in_flight"] == programme["frames_in_flight"] == "1"
    assert policy["vertex_order"] == "cache"
    assert policy["fovy_deg"] == "60"


def test_a_clock_of_this_thread_counts_what_it_works(record: Record) -> None:
    """A frame of one thread takes as much of it as of the process, whoever else works there."""
    assert record("--calibrate", "--steps", "4", "--clock", "thread", out="log.parquet") == 0
    columns = ParquetColumns(Path("log.parquet"))
    drawn_ms = sum(columns.numbers(name).sum() for name in ("frame_ms", "reference_after_ms"))
    assert 0.0 < drawn_ms < 1e3 * time.process_time()


def test_frames_in_flight(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    """Lag is told where frames are drawn deep, and each column that it stands on."""
    flight = ["--frames-in-flight", "2", "--threads", "1"]
    assert record(*STATIC, *flight, "--frame-log", "frames.parquet", out="log.parquet") == 0
    assert "ms after its input, 2 in flight" in capsys.readouterr().out
    frames, columns = read_frame_log(Path("frames.parquet")), ParquetColumns(Path("log.parquet"))
    lag_ms = 1e-6 * (frames["gpu_end_ns"] - frames["input_ns"])
    assert columns.numbers("lag_ms") == pytest.approx(lag_ms)
    assert (columns.numbers("prepare_ms") > 0.0).all()
    header = dict(read_render_log(Path("log.parquet")).header)
    assert (header["frames_in_flight"], header["repeats"]) == ("2", "1")
    assert header["gpu_ms"] == "left out, frames overlap"
    assert "reference_before_ms" not in columns.names


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*STATIC, "--clock", "sun"], "--clock: expected one of wall, thread, got sun"),
        (
            [*STATIC, "--clock", "thread", "--threads", "1"],
            "--clock thread: expected a renderer that draws in the caller's thread",
        ),
        ([*STATIC, "--frames-in-flight", "5"], "--frames-in-flight: expected 1 to 4"),
        (
            [*STATIC, "--frames-in-flight", "2"],
            "--frames-in-flight: expected a renderer that draws beside the caller's thread",
        ),
        (
            [*STATIC, "--frames-in-flight", "2", "--threads", "1", "--clock", "thread"],
            "--frames-in-flight: expected --clock wall, got thread",
        ),
        (
            ["--calibrate", "--frames-in-flight", "2", "--threads", "1"],
            "--frames-in-flight: expected a policy whose frames nothing waits for, got --calibrate",
        ),
        (
            [*STATIC, "--frames-in-flight", "2", "--threads", "1", "--images", "pictures"],
            "--frames-in-flight: expected a policy whose frames nothing waits for, got --images",
        ),
        (
            ["--calibrate", "--images", "pictures"],
            "--images: expected --policy, got --cal",
        ),
    ],
)
def test_refusals(
    record: Record, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line on stderr, exit code 2, and nothing written."""
    assert record(*arguments) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith(f"error: {message}")
    assert printed.err.count("\n") == 1
    assert list(Path().iterdir()) == []
