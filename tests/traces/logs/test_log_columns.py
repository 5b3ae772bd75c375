"""Columns by alias, by mapping, and by unit."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.log_columns import ALIASES, find_columns, unit_of
from lodbench.traces.logs.render_log import COUNTS, TIMES


def found(header: Sequence[str], mapping: dict[str, str] | None = None) -> dict[str, str]:
    """Return the sources of the columns found."""
    columns, _ = find_columns(header, mapping, path=Path("log.csv"), line=1)
    return {column.name: column.source for column in columns}


def test_every_name_is_an_alias_of_itself():
    """A log written with lodbench's own names is read without a mapping."""
    own = list(dict.fromkeys((*COUNTS, *TIMES, "time_s")))
    assert found(own) == dict(zip(own, own, strict=True))


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("drawCalls", "draw_calls"),
        ("RHI/DrawCalls", "draw_calls"),
        ("Draw Calls Count", "draw_calls"),
        ("info.render.calls", "draw_calls"),
        ("RENDER_TOTAL_DRAW_CALLS_IN_FRAME", "draw_calls"),
        ("batches", "draw_calls"),
        ("tris", "triangles"),
        ("prims", "triangles"),
        ("RHI/PrimitivesDrawn", "triangles"),
        ("Triangles Count", "triangles"),
        ("SetPass Calls Count", "state_changes"),
        ("Vertices Count", "vertices"),
        ("GPUTime", "gpu_ms"),
        ("GPU Frame Time", "gpu_ms"),
        ("gpuTime_us", "gpu_ms"),
        ("MsGPUBusy", "gpu_ms"),
        ("msGPUActive", "gpu_ms"),
        ("CPU Main Thread Frame Time", "cpu_ms"),
        ("FrameTime", "frame_ms"),
        ("Frame Time (ms)", "frame_ms"),
        ("dt", "frame_ms"),
    ],
)
def test_names_that_tools_write_are_known(source: str, name: str):
    """The aliases cover the columns of the tools, whatever case and punctuation."""
    header = [source] if name in TIMES else [source, "frame_ms"]
    assert found(header)[name] == source


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("gpu_ms", "ms"),
        ("Frame Time (ms)", "ms"),
        ("gpu_time_us", "us"),
        ("gpu [µs]", "us"),
        ("gpuTimeNs", "ns"),
        ("MsGPUBusy", "ms"),
        ("msGPUActive", "ms"),
        ("TimeInSeconds", "s"),
        ("time_s", "s"),
        ("GPUTime", ""),
        ("draws", ""),
        ("Columns", ""),
        ("status", ""),
    ],
)
def test_units_come_from_the_convention_of_the_name(name: str, unit: str):
    """A unit is a suffix set off by punctuation or case, or the prefix of PresentMon."""
    assert unit_of(name) == unit


def test_the_better_alias_wins_and_the_other_is_noted():
    """Busy time goes before a time that may include waiting, calls before batches."""
    header = ["GPUTime", "GPUBusy", "Batches Count", "Draw Calls Count"]
    columns, notes = find_columns(header, None, path=Path("log.csv"), line=1)
    sources = {column.name: column.source for column in columns}
    assert sources == {"gpu_ms": "GPUBusy", "draw_calls": "Draw Calls Count"}
    assert "gpu_ms is GPUBusy; GPUTime left aside" in notes


def test_a_mapping_goes_before_the_aliases():
    """What the user says holds, even against a column with the very name."""
    header = ["gpu_ms", "Mine", "Prims"]
    assert found(header, {"gpu_ms": "Mine"}) == {"gpu_ms": "Mine", "triangles": "Prims"}


@pytest.mark.parametrize(
    ("mapping", "says"),
    [
        ({"gpu": "Mine"}, "expected one of .*got gpu;"),
        ({"trangles": "Mine"}, r"did you mean triangles\?"),
        ({"gpu_ms": "Mien"}, r"one of Mine, frame_ms, got Mien; did you mean Mine\?"),
    ],
)
def test_a_mapping_of_what_is_not_there_is_refused(mapping: dict[str, str], says: str):
    """Both sides of a mapping are checked, each with the nearest name."""
    with pytest.raises(InputError, match=says):
        found(["Mine", "frame_ms"], mapping)


def test_a_needed_column_that_stands_twice_is_refused():
    """Nobody can know which of two columns of one name was meant, except where a tool says."""
    header = ["frame_ms", "triangles", "triangles"]
    with pytest.raises(InputError, match="one column triangles, got 2"):
        found(header)
    columns, _ = find_columns(header, None, path=Path("log.csv"), line=1, twins=True)
    assert [column.index for column in columns if column.name == "triangles"] == [1]
    assert found(["frame_ms", "other", "other"]) == {"frame_ms": "frame_ms"}


def test_a_log_without_a_time_is_refused():
    """Predictors alone measure nothing."""
    with pytest.raises(InputError, match="expected a column with a time"):
        found(["draws", "tris"])


def test_no_alias_stands_for_two_names():
    """The table is a function from alias to name."""
    aliases = [alias for group in ALIASES.values() for alias in group]
    assert len(aliases) == len(set(aliases))


def test_counts_of_one_type_are_columns_of_their_own(tmp_path: Path):
    """``triangles[tree]`` is a predictor beside ``triangles``; an unknown count is not."""
    header = ["gpu_ms", "triangles", "triangles[tree]", "mood[tree]"]
    columns, _ = find_columns(header, None, path=tmp_path, line=1)
    assert [(column.name, column.index) for column in columns] == [
        ("triangles", 1),
        ("gpu_ms", 0),
        ("triangles[tree]", 2),
    ]
