"""Captures of Unreal's CSV profiler, with the traps of their layout."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.unreal_csv import read_unreal_csv
from lodbench.traces.logs.read_log import log_format_of

FIRST = "EVENTS,FrameTime,RenderThreadTime,GameThreadTime,GPUTime,RHI/DrawCalls"
COMPLETE = f"{FIRST},RHI/PrimitivesDrawn,RHIThreadTime"
METADATA = (
    "[HasHeaderRowAtEnd],1,[platform],Windows,[config],Test,[engineversion],5.5.1,"
    "[commandline],game -csv,-windowed,-res=1920"
)
ROWS = (
    ",33.0,5.0,8.0,3.0017,0",
    "Load;Spawn,16.9,11.0,8.0,3.0017,5690",
    ",17.1,6.0,8.5,20.2,5691,5000000,1.5",
    ",17.3,6.0,8.5,20.4,5700,5100000,14.0",
)


def capture(tmp_path: Path, *lines: str, end: str = "\n") -> Path:
    """Write a file of these lines."""
    path = tmp_path / "Profile(20240101_120000).csv"
    path.write_text("\n".join(lines) + end, encoding="utf-8")
    return path


def test_the_complete_header_at_the_end_is_the_one_that_counts(tmp_path: Path):
    """Stats that first appeared in row 3 are read, and are missing in the rows before."""
    path = capture(tmp_path, FIRST, *ROWS, COMPLETE, METADATA)
    assert log_format_of(path) == "unreal"
    log = read_unreal_csv(path)
    assert len(log) == 4
    assert set(log.predictors) == {"draw_calls", "triangles"}
    triangles = log.columns(["triangles"])[:, 0]
    np.testing.assert_array_equal(triangles, [np.nan, np.nan, 5e6, 5.1e6])
    assert log.time("gpu_ms").tolist() == [3.0017, 3.0017, 20.2, 20.4]
    assert log.time("frame_ms").tolist() == [33.0, 16.9, 17.1, 17.3]


def test_cpu_time_is_that_of_the_busiest_thread(tmp_path: Path):
    """Game, render and RHI threads overlap, so a frame cannot be shorter than the longest."""
    log = read_unreal_csv(capture(tmp_path, FIRST, *ROWS, COMPLETE, METADATA))
    assert log.time("cpu_ms").tolist() == [8.0, 11.0, 8.5, 14.0]
    assert any("longest of GameThreadTime, RenderThreadTime, RHIThreadTime" in n for n in log.notes)


def test_metadata_are_pairs_whose_last_value_may_hold_commas(tmp_path: Path):
    """The command line keeps its commas."""
    log = read_unreal_csv(capture(tmp_path, FIRST, *ROWS, COMPLETE, METADATA))
    header = dict(log.header)
    assert header["engineversion"] == "5.5.1"
    assert header["commandline"] == "game -csv,-windowed,-res=1920"


def test_an_unfinished_capture_is_read_as_far_as_it_goes(tmp_path: Path):
    """Without metadata the first header holds, a row cut off is left aside, and both are noted."""
    log = read_unreal_csv(capture(tmp_path, FIRST, *ROWS[:3], ",17.", end=""))
    assert len(log) == 3
    assert any("did not finish" in note for note in log.notes)
    assert any("cut off" in note for note in log.notes)


def test_metadata_of_old_captures_follow_the_rows(tmp_path: Path):
    """Before 4.23 the header stands at the top alone, and metadata still end the file."""
    log = read_unreal_csv(capture(tmp_path, FIRST, *ROWS[:2], "[platform],PS4,[config],Test"))
    assert len(log) == 2
    assert dict(log.header) == {"platform": "PS4", "config": "Test"}


def test_names_that_repeat_do_not_matter(tmp_path: Path):
    """Of two columns of one name the first is read."""
    header = "EVENTS,FrameTime,GPUTime,GPUTime"
    log = read_unreal_csv(capture(tmp_path, header, ",16.0,5.0,9.0", header, METADATA))
    assert log.time("gpu_ms").tolist() == [5.0]


def test_nanite_is_noted(tmp_path: Path):
    """Its triangles are in no counter of draws."""
    header = "EVENTS,FrameTime,GPUTime,DynamicNaniteScalingPrimary"
    log = read_unreal_csv(capture(tmp_path, header, ",16.0,5.0,1.0", header, METADATA))
    assert any("Nanite" in note for note in log.notes)


def test_a_mapping_reads_a_pass_instead(tmp_path: Path):
    """Any column of a capture can stand for a time or a predictor."""
    header = "EVENTS,FrameTime,GPUTime,GPU/BasePass,DrawCall/Basepass"
    path = capture(tmp_path, header, ",16.0,5.0,3.0,77", header, METADATA)
    log = read_unreal_csv(path, {"gpu_ms": "GPU/BasePass", "draw_calls": "DrawCall/Basepass"})
    assert log.time("gpu_ms").tolist() == [3.0]
    assert log.columns(["draw_calls"]).tolist() == [[77.0]]


def test_broken_captures_are_refused(tmp_path: Path):
    """No rows, no header where the metadata say so; words for numbers are missing values."""
    with pytest.raises(InputError, match="rows below the header, got none"):
        read_unreal_csv(capture(tmp_path, FIRST, FIRST, METADATA))
    with pytest.raises(InputError, match="expected the header before the metadata"):
        read_unreal_csv(capture(tmp_path, FIRST, *ROWS, METADATA))
    log = read_unreal_csv(capture(tmp_path, FIRST, ROWS[0], ",x,1,1,1,1", COMPLETE, METADATA))
    assert "1 cell of FrameTime is no number, such as 'x': missing" in log.warnings
