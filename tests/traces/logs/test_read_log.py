"""Render logs from files: recognised by content, named, damaged, large, and the real ones."""

import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.traces.logs.log_checks import check_log
from lodbench.traces.logs.read_log import LOG_FORMATS, read_render_log
from lodbench.traces.logs.render_log import measurable

OWN = """\
# renderer: llvmpipe (LLVM 15); 4.5 Mesa 22.3.6; 640x360; mode random; seed 31
frame,time_s,draw_calls,triangles,cpu_ms,gpu_ms,frame_ms
0,0.0,54,335842,29.7,4294.9673,40.2
1,0.1,134,746014,68.4,36.3,68.4
"""


def log_file(tmp_path: Path, content: str | bytes, name: str = "run.csv") -> Path:
    """Write a file of this content."""
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def test_lodbench_own_csv(tmp_path: Path):
    """Predictors, times and the comment line are read; the resolution becomes a predictor."""
    log = read_render_log(log_file(tmp_path, OWN))
    assert (log.name, log.format, len(log)) == ("run", "csv", 2)
    assert dict(log.header) == {
        "renderer": "llvmpipe (LLVM 15)",
        "version": "4.5 Mesa 22.3.6",
        "resolution": "640x360",
        "mode": "random",
        "seed": "31",
    }
    columns = log.columns(["draw_calls", "triangles", "framebuffer_pixels"])
    assert columns.tolist() == [[54, 335842, 230400], [134, 746014, 230400]]
    assert log.time("frame_ms").tolist() == [40.2, 68.4]


def test_parquet_holds_the_same_log(tmp_path: Path):
    """The columns of the CSV as Parquet, with its comment in the metadata, give an equal log."""
    csv = read_render_log(log_file(tmp_path, OWN))
    table = pa.table(
        {
            "draw_calls": [54, 134],
            "triangles": [335842, 746014],
            "time_s": [0.0, 0.1],
            "cpu_ms": [29.7, 68.4],
            "gpu_ms": [4294.9673, 36.3],
            "frame_ms": [40.2, 68.4],
            "note": ["a", "b"],
        }
    ).replace_schema_metadata({"lodbench.header": OWN.splitlines()[0].removeprefix("# ")})
    path = tmp_path / "run.parquet"
    pq.write_table(table, path)
    log = read_render_log(path)
    assert (log.format, log.predictors, log.header) == ("parquet", csv.predictors, csv.header)
    np.testing.assert_array_equal(log.counts, csv.counts)
    for name in csv.times:
        np.testing.assert_array_equal(log.time(name), csv.time(name))


def test_broken_parquet_is_refused(tmp_path: Path):
    """Cut off, without rows, with words for numbers, or in the place of a folder."""
    path = tmp_path / "run.parquet"
    pq.write_table(pa.table({"frame_ms": [1.0] * 100}), path)
    log_file(tmp_path, path.read_bytes()[:-20], "cut.parquet")
    pq.write_table(pa.table({"frame_ms": pa.array([], pa.float64())}), tmp_path / "none.parquet")
    pq.write_table(pa.table({"frame_ms": ["fast"]}), tmp_path / "words.parquet")
    for name, says in [("cut", "Parquet"), ("none", "at least one frame"), ("words", "numbers")]:
        with pytest.raises(InputError, match=says):
            read_render_log(tmp_path / f"{name}.parquet")
    with pytest.raises(InputError, match="a file that can be read"):
        read_render_log(tmp_path)


def test_a_mapping_reads_any_csv(tmp_path: Path):
    """Columns of any name are read when they are mapped, in the unit that their name says."""
    path = log_file(tmp_path, "what;busy_us;n\nx;2500;7\n")
    log = read_render_log(path, {"gpu_ms": "busy_us", "triangles": "n"})
    assert log.time("gpu_ms").tolist() == [2.5]
    assert log.columns(["triangles"]).tolist() == [[7.0]]


def test_the_format_can_be_named(tmp_path: Path):
    """A name overrides recognition; an unknown one suggests the nearest; timings take no map."""
    path = log_file(tmp_path, "EVENTS,FrameTime,GPUTime\n,16,5\n")
    assert read_render_log(path).format == "unreal"
    assert read_render_log(path, log_format="csv").format == "csv"
    with pytest.raises(InputError, match=r"did you mean mangohud\?"):
        read_render_log(path, log_format="mangohood")
    with pytest.raises(InputError, match="no mapping, since a mangohud log"):
        read_render_log(path, {"gpu_ms": "GPUTime"}, "mangohud")


def test_a_clock_without_a_unit_takes_the_one_that_fits_the_frames(tmp_path: Path):
    """A column t of milliseconds is not taken for seconds."""
    log = read_render_log(log_file(tmp_path, "t,dt,drawCalls\n100,16,5\n116,16,6\n132,16,7\n"))
    assert log.time_s is not None
    assert log.time_s.tolist() == [0.1, 0.116, 0.132]


LAST = OWN.splitlines()[-1]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (OWN.split("0,0.0", 1)[0] + LAST.replace(",", ";"), "delimiter of the header, ','"),
        (OWN.split("\n", 2)[2], "expected a header row"),
        (OWN.replace("cpu_ms", "gpu_ms"), "one column gpu_ms, got 2"),
        (OWN.split("0,0.0", 1)[0], "rows below the header, got none"),
        (OWN.replace("_ms", "").replace("time_s", "where"), "a column with a time"),
        ("", "empty file"),
        (OWN + "\0\1\2", "zero byte"),
        (OWN.encode() + b"\xff\xfe\xfa", "expected UTF-8 text, got byte 0xff"),
        ('{"traceEvents": [{"ph": "X"}]}', "Chrome trace events"),
    ],
)
def test_each_damage_has_one_clear_line(tmp_path: Path, content: str | bytes, says: str):
    """Truncated, wrongly delimited, headless, empty or binary files each say what is wrong."""
    path = log_file(tmp_path, content)
    with pytest.raises(InputError, match=says) as caught:
        read_render_log(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_log_that_is_cut_off_is_read_as_far_as_it_goes(tmp_path: Path):
    """The last row, of which the last number may be cut too, is left aside and that is said."""
    log = read_render_log(log_file(tmp_path, OWN[:-7]))
    assert len(log) == 1
    assert "the last row is cut off and left aside" in log.warnings


starts = st.sampled_from(
    [
        OWN.encode(),
        b"EVENTS,FrameTime,GPUTime,RHI/DrawCalls\n,16,5,9\n,17,5,9\n[HasHeaderRowAtEnd],1\n",
        b"os,cpu,gpu,ram\na,b,c,d\nfps,frametime,elapsed\n60,16.6,0\n60,16.6,1\n",
        b"CPU Main Thread Frame Time,GPU Frame Time,Triangles Count\n6,9,8\n",
        b"Application,ProcessID,SwapChainAddress,TimeInSeconds,msBetweenPresents\na,1,0x1,1,16\n",
        b'{"Runs": [{"CaptureData": {"TimeInSeconds": [0.1], "MsBetweenPresents": [5]}}]}',
        b"PAR1 PAR1",
        b"\xff\xfea\0,\0b\0",
    ]
)


@given(starts, st.integers(0, 200), st.integers(0, 60), st.binary(max_size=12))
@settings(max_examples=300, deadline=None)
def test_only_input_errors_come_out_of_any_bytes(
    tmp_path_factory: pytest.TempPathFactory, start: bytes, at: int, cut: int, noise: bytes
):
    """Bytes cut out of or put into any format give a log or one line of error."""
    path = tmp_path_factory.getbasetemp() / "fuzzed.csv"
    path.write_bytes(start[:at] + noise + start[at + cut :])
    try:
        log = read_render_log(path)
    except InputError as error:
        message = str(error)
    else:
        message = ""
        assert len(log) >= 1
        for name in log.times:
            keep, rejections = measurable(log, name, log.predictors)
            assert keep.sum() + sum(r.count for r in rejections) == len(log)
    assert "\n" not in message


@pytest.mark.slow
def test_a_million_rows_are_read_in_seconds(tmp_path: Path):
    """A 60 MB log is read in under 10 s, and with a broken last line too, if more slowly."""
    row = "1,0.0167,134,746014,68.3834,36.2575,68.4175\n"
    header = "\n".join(OWN.splitlines()[:2]) + "\n"
    path = log_file(tmp_path, header + row * 1_000_000)
    start = time.perf_counter()
    assert len(read_render_log(path)) == 1_000_000
    assert time.perf_counter() - start < 10.0
    with path.open("a") as file:
        file.write("1,2\n")
    assert len(read_render_log(path)) == 1_000_001


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "log_format", "frames", "predictors"),
    [
        ("llvmpipe-1thread-distance-a.csv", "csv", 400, 5),
        ("llvmpipe-1thread-random-a.csv", "csv", 400, 5),
        ("llvmpipe-distance-a.csv", "csv", 400, 5),
        ("llvmpipe-random-a.csv", "csv", 500, 5),
        ("llvmpipe-swing-a.csv", "csv", 400, 5),
        ("threejs-pirateconquest-large_battle.csv", "csv", 3599, 1),
        ("presentmon-v1-farcrynewdawn.csv", "presentmon-v1", 1171, 0),
        ("presentmon-v1.csv", "presentmon-v1", 19, 0),
        ("presentmon-v2.csv", "presentmon-v2", 18, 0),
        ("presentmon-v2-default.csv", "presentmon", 18, 0),
        ("ocat-metroexodus.csv", "presentmon-v1", 2502, 0),
        ("capframex-with-header.csv", "capframex", 7285, 0),
    ],
)
def test_every_real_log_has_its_frames(
    data_dir: Path, name: str, log_format: str, frames: int, predictors: int
):
    """Each file of the collection is recognised and read whole (of PresentMon, one stream)."""
    log = read_render_log(data_dir / "logs" / name)
    assert (log.format, len(log), len(log.predictors)) == (log_format, frames, predictors)


@pytest.mark.realdata
def test_the_first_gpu_time_of_llvmpipe_ran_over(data_dir: Path):
    """The counter of 2^32 ns is left out, and the column refused as a software timer's."""
    for path in sorted((data_dir / "logs").glob("llvmpipe-*.csv")):
        log = read_render_log(path)
        _, rejections = measurable(log, "gpu_ms", ["triangles"])
        assert "1 gpu_ms of a timer that ran over" in [str(r) for r in rejections]
        refused = [finding.column for finding in check_log(log) if finding.refuse]
        assert refused == ["gpu_ms"]


@pytest.mark.realdata
def test_the_capped_logs_are_found_capped(data_dir: Path):
    """The three.js log is locked to 59.97 Hz; Far Cry ran against a cap of 80; others run free."""
    capped: dict[str, str] = {}
    for path in sorted((data_dir / "logs").glob("*.csv")):
        for finding in check_log(read_render_log(path)):
            if finding.kind == "capped":
                capped[path.name] = finding.message
    assert set(capped) == {
        "threejs-pirateconquest-large_battle.csv",
        "presentmon-v1-farcrynewdawn.csv",
    }
    assert "59.97 Hz" in capped["threejs-pirateconquest-large_battle.csv"]


def test_every_format_says_what_it_is():
    """The table that the command line prints has one line for each."""
    assert all("\n" not in (LOG_FORMATS.find(name).what or "\n") for name in LOG_FORMATS)


def test_names_of_columns_neither_move_the_cursor_nor_are_markup(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """What a file calls its columns is printed as text, whatever its letters do elsewhere."""
    path = tmp_path / "a.csv"
    rows = "\n".join(f"{8 + i % 3},{i},{i}" for i in range(20))
    path.write_text(f"gpu_ms [/ms],x\x1b[2J,\u202ebold\n{rows}\n", encoding="utf-8")
    assert run(["log", "info", str(path), "--map", "gpu_ms=gpu_ms [/ms]"]) == 0
    out, err = capsys.readouterr()
    assert all(line.isprintable() for line in (*out.splitlines(), *err.splitlines()))
    assert "gpu_ms [/ms]" in out
    assert "x?[2J" in out
