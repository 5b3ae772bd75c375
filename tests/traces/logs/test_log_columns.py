"""Columns by alias, by mapping, and by unit."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.columns.column_words import words_of
from lodbench.traces.logs.log_columns import FoundColumns, find_columns
from lodbench.traces.logs.render_log import COUNTS, TIMES


def found(header: Sequence[str], mapping: dict[str, str] | None = None) -> dict[str, str]:
    """Return the sources of the columns found."""
    return {column.name: column.source for column in look(header, mapping).columns}


def look(header: Sequence[str], mapping: dict[str, str] | None = None) -> FoundColumns:
    """Return all that is found in a header."""
    return find_columns(header, mapping, path=Path("log.csv"), line=1)


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
        ("render_gpu_ms", "gpu_ms"),
        ("FrameGPUTime", "gpu_ms"),
        ("gputime [us]", "gpu_ms"),
        ("GPU frame (ms)", "gpu_ms"),
        ("gfx_time_ms", "gpu_ms"),
        ("game_thread_ms", "cpu_ms"),
        ("viewport_get_measured_render_time_cpu", "cpu_ms"),
        ("interval_ms", "frame_ms"),
        ("deltaTimeSeconds", "frame_ms"),
        ("FRAMETIME", "frame_ms"),
        ("ms", "frame_ms"),
        ("Triangles (M)", "triangles"),
        ("kTris", "triangles"),
        ("stats.prims", "triangles"),
        ("num_draw_calls", "draw_calls"),
        ("vertCount", "vertices"),
    ],
)
def test_names_that_tools_write_are_known(source: str, name: str):
    """The words of a name say its role, whatever case, order and punctuation."""
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
        ("gpuMicros", "us"),
        ("frame time in milliseconds", "ms"),
    ],
)
def test_units_come_from_the_convention_of_the_name(name: str, unit: str):
    """A unit is a suffix set off by punctuation or case, or the prefix of PresentMon."""
    assert words_of(name).unit == unit


@pytest.mark.parametrize(
    ("name", "multiplier"),
    [("Triangles (M)", 1e6), ("tris [k]", 1e3), ("MTris", 1e6), ("ktris", 1e3), ("tris_k", 1e3)],
)
def test_multiples_come_from_the_name_too(name: str, multiplier: float):
    """Thousands and millions are spelt as units are."""
    words = words_of(name)
    assert (words.words, words.multiplier) == (("triangles",), multiplier)


@pytest.mark.parametrize(
    "name",
    [
        *("GPU0Util(%)", "gpu_temp", "gpu_core_clock", "GPUWait", "InputLatencyTime"),
        *("MaxFrameTime", "RenderThreadTime_CriticalPath", "frame", "FrameIndex", "cpu_load"),
        *("target_frame_ms", "budget_ms", "triangles_max", "gpu_mem_ms_mb", "objects", "total_ms"),
        *("gpu_shadow_ms", "DrawCall/Basepass", "Dynamic Batched Triangles Count"),
    ],
)
def test_what_only_resembles_is_left_alone(name: str):
    """Loads, limits, waits and parts of a frame are no time and no count of it."""
    assert set(found(["gpu_ms", "frame_ms", "cpu_ms", name]).values()) == {
        *("gpu_ms", "frame_ms", "cpu_ms")
    }


def test_threads_are_the_cpu_together():
    """Of game, render and RHI thread the longest counts, unless a time of the CPU is there."""
    threads = ["game_thread_ms", "render_thread_ms", "rhi_thread_ms"]
    columns = look(["frame_ms", *threads]).columns
    assert [column.source for column in columns if column.name == "cpu_ms"] == threads
    assert found(["cpu_ms", *threads]) == {"cpu_ms": "cpu_ms"}


def test_several_parts_are_asked_about():
    """Of passes none is the GPU's time; the note says how to choose one."""
    seen = look(["frame_ms", "gpu_shadow_ms", "gpu_base_ms"])
    assert [column.name for column in seen.columns] == ["frame_ms"]
    assert any("--map gpu_ms=gpu_shadow_ms" in note for note in seen.notes)


def test_a_column_serves_one_name():
    """A mapped column is no clock besides, and two names cannot share one."""
    assert found(["frame", "time", "tris"], {"gpu_ms": "time"}) == {
        "gpu_ms": "time",
        "triangles": "tris",
    }
    with pytest.raises(InputError, match="to serve one name, got Mine for gpu_ms and cpu_ms"):
        found(["Mine"], {"gpu_ms": "Mine", "cpu_ms": "Mine"})


def test_units_are_mapped_behind_a_colon():
    """``gpu_ms=span:us`` states the unit, and ``triangles=n:k`` the thousands."""
    columns = look(["span", "n", "a:b"], {"gpu_ms": "span:us", "triangles": "n:k"}).columns
    assert [(c.source, c.unit, c.multiplier, c.stated) for c in columns] == [
        ("span", "us", 1.0, True),
        ("n", "", 1e3, True),
    ]
    assert found(["a:b"], {"gpu_ms": "a:b"}) == {"gpu_ms": "a:b"}
    with pytest.raises(InputError, match="span:UNIT with one of ns, us, ms, s, got min"):
        look(["span"], {"gpu_ms": "span:min"})


def test_the_better_alias_wins_and_the_other_is_noted():
    """Busy time goes before a time that may include waiting, calls before batches."""
    header = ["GPUTime", "GPUBusy", "Batches Count", "Draw Calls Count"]
    assert found(header) == {"gpu_ms": "GPUBusy", "draw_calls": "Draw Calls Count"}
    assert "gpu_ms is GPUBusy; GPUTime left aside" in look(header).notes


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
    seen = find_columns(header, None, path=Path("log.csv"), line=1, twins=True)
    assert [column.index for column in seen.columns if column.name == "triangles"] == [1]
    assert found(["frame_ms", "other", "other"]) == {"frame_ms": "frame_ms"}


def test_a_log_without_a_time_is_refused():
    """Predictors alone measure nothing."""
    with pytest.raises(InputError, match="expected a column with a time"):
        found(["draws", "tris"])


def test_counts_of_one_type_are_columns_of_their_own(tmp_path: Path):
    """``triangles[tree]`` is a predictor beside ``triangles``; an unknown count is not."""
    header = ["gpu_ms", "triangles", "triangles[tree]", "mood[tree]"]
    columns = find_columns(header, None, path=tmp_path, line=1).columns
    assert [(column.name, column.index) for column in columns] == [
        ("gpu_ms", 0),
        ("triangles", 1),
        ("triangles[tree]", 2),
    ]
