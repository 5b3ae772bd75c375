"""Units of times: by name, by size, against a clock, and asked for where nothing decides."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.read_log import read_render_log
from lodbench.traces.logs.render_log import RenderLog


def log_of(tmp_path: Path, mapping: dict[str, str] | None = None, **columns: float) -> RenderLog:
    """Read 50 rows of columns with these medians; a column called time runs on by its value."""
    rows = np.outer(np.linspace(0.9, 1.1, 50), list(columns.values()))
    for place, name in enumerate(columns):
        if name.startswith("time"):  # time, timestamp, time_s
            rows[:, place] = np.arange(50) * columns[name]
    path = tmp_path / "units.csv"
    lines = [",".join(columns), *(",".join(f"{cell:.9g}" for cell in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_render_log(path, mapping)


def median(log: RenderLog, name: str) -> float:
    """Return the median of a time in ms."""
    return float(np.median(getattr(log, name)))


@pytest.mark.parametrize(
    ("value", "size_ms"), [(16.7, 16.7), (0.0167, 16.7), (16_700.0, 16.7), (16.7e6, 16.7), (5, 5)]
)
def test_the_size_says_the_unit(tmp_path: Path, value: float, size_ms: float):
    """A frame of 16.7 ms is told in any of four units, and the note says which it was."""
    log = log_of(tmp_path, frameTime=value, tris=1e5)
    assert median(log, "frame_ms") == pytest.approx(size_ms)
    assert any("by their size" in note for note in log.notes)


@pytest.mark.parametrize("value", [0.4, 400.0, 4e5])
def test_doubt_is_asked_about_and_the_answer_is_taken(tmp_path: Path, value: float):
    """What may be fast or slow by the thousand is refused with mappings that then work."""
    with pytest.raises(InputError, match=r"--map frame_ms=frameTime:\w+ or --map") as caught:
        log_of(tmp_path, frameTime=value)
    for part in caught.value.message.split("--map ")[1:]:
        name, _, given = part.split(" or ")[0].strip().partition("=")
        log = log_of(tmp_path, {name: given}, frameTime=value)
        assert 0.02 <= median(log, "frame_ms") <= 1e3


def test_a_clock_decides(tmp_path: Path):
    """Frame times of 0.4 that add up to a clock's seconds are ms or s, as the clock says."""
    slow = log_of(tmp_path, frameTime=0.4, time_s=0.4)
    assert median(slow, "frame_ms") == pytest.approx(400.0)
    fast = log_of(tmp_path, frameTime=0.4, time_s=0.0004)
    assert median(fast, "frame_ms") == pytest.approx(0.4)


def test_busy_times_take_the_unit_of_the_frame(tmp_path: Path):
    """0.08 beside frames of 0.1 s is a GPU of 80 ms; beside frames of 0.1 ms, one of 0.08."""
    seconds = log_of(tmp_path, deltaTime=0.1, gpuTime=0.08)
    assert median(seconds, "gpu_ms") == pytest.approx(80.0)
    ms = log_of(tmp_path, frame_ms=0.1, gpuTime=0.08)
    assert median(ms, "gpu_ms") == pytest.approx(0.08)


def test_a_name_is_not_believed_against_its_size(tmp_path: Path):
    """``frame_ms`` of 0.0167 is seconds for sure or a renderer at 60,000 frames a second."""
    with pytest.raises(InputError, match="--map frame_ms=frame_ms:s"):
        log_of(tmp_path, frame_ms=0.0167)
    assert median(log_of(tmp_path, gpu_ms=0.01), "gpu_ms") == pytest.approx(0.01)


def test_counts_in_millions_are_multiplied(tmp_path: Path):
    """``Triangles (M)`` of 2.5 are 2,500,000, and the note says so."""
    columns: dict[str, Any] = {"gpu_ms": 5.0, "Triangles (M)": 2.5}
    log = log_of(tmp_path, **columns)
    assert np.median(log.counts) == pytest.approx(2.5e6)
    assert "triangles is Triangles (M) times 1e+06" in log.notes


def test_a_column_that_jumps_back_and_forth_is_no_clock(tmp_path: Path):
    """``time`` that holds durations is not used, and the warning says how to use it."""
    path = tmp_path / "log.csv"
    rows = [f"{7.0 + 3.0 * (-1) ** k},16.0" for k in range(40)]
    path.write_text("\n".join(["time,frame_ms", *rows]) + "\n", encoding="utf-8")
    log = read_render_log(path)
    assert log.time_s is None
    assert "time runs backwards" in log.warnings[0]


def test_a_clock_alone_has_the_frame_times_in_its_steps(tmp_path: Path):
    """Its unit comes from their size; a column that is no clock is refused with the mapping."""
    log = log_of(tmp_path, timestamp=16_667.0, gpu=5.0, tris=1e5)
    assert np.nanmedian(log.time("frame_ms")) == pytest.approx(16.667)
    assert "frame_ms is the steps of timestamp in ms" in log.notes
    assert any("smells of a time: gpu" in warning for warning in log.warnings)
    path = tmp_path / "log.csv"
    rows = [f"{7.0 + 3.0 * (-1) ** k},9" for k in range(40)]
    path.write_text("\n".join(["time,tris", *rows]) + "\n", encoding="utf-8")
    with pytest.raises(InputError, match="--map gpu_ms=time"):
        read_render_log(path)
    assert len(read_render_log(path, {"gpu_ms": "time"})) == 40


def test_frame_rates_serve_where_there_is_no_time(tmp_path: Path):
    """A log of fps alone has frame times of 1000 / fps."""
    log = log_of(tmp_path, fps=50.0, tris=1e5)
    assert median(log, "frame_ms") == pytest.approx(20.0, rel=0.01)
    assert log.notes[0] == "frame_ms is 1000 / fps in ms"
    assert "fps" in log_of(tmp_path, fps=50.0, gpu_ms=5.0).unused
