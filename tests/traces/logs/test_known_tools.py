"""Files of known tools: named, each with what to do instead; Fraps and MangoHud without header."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.read_log import read_render_log


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.rdc", b"RDOC\x00\x01", "a RenderDoc capture"),
        ("a.csv", b"EID,Event,Duration (us)\n1,Draw,2\n", "RenderDoc's list of events"),
        ("a.wpix", b"\x00\x01", "a PIX capture"),
        ("a.csv", b"Global ID,Name,EOP to EOP Duration (ns)\n1,D,3\n", "PIX's list of events"),
        ("a.nsys-rep", b"\x01\x02", "a report of Nsight"),
        ("a.sqlite", b"SQLite format 3\x00", "a data base of SQLite"),
        ("a.csv", b"Time (%),Total Time (ns),Instances,Name\n5,6,7,k\n", "a summary of Nsight"),
        ("Profile.csv.bin", b"\x00\x01\x02", "a binary capture of Unreal's CSV profiler"),
        ("Profile.csv.gz", b"\x1f\x8b\x08", "an archive packed with gzip"),
        (
            "a.log",
            b"LogRHI: 9.1% 0.49ms   Basepass 6 draws 900 prims 800 verts\n",
            "a log of Unreal's ProfileGPU",
        ),
        ("FrameView_Summary.csv", b"Application,GPU\na,b\n", "the summary of FrameView"),
        ("a.csv", b"Duration,Total Frames,Average FPS\n1,60,60\n", "PresentMon's statistics"),
        ("a fps.csv", b"FPS\n60\n61\n", "Fraps' frame rates by second"),
        ("a minmaxavg.csv", b"Frames, Time (ms), Min, Max, Avg\n9,1,2,3,4\n", "Fraps' summary"),
        (
            "Benchmark.txt",
            b"01-02-2025, 10:00:00 a.exe benchmark completed, 90 frames rendered in 1.5 s\n",
            "the summary of an RTSS benchmark",
        ),
        ("a.xlsx", b"PK\x03\x04", "save it as CSV"),
        ("a.etl", b"\x00\x01", "Event Tracing for Windows"),
    ],
)
def test_tools_without_a_table_of_frames_are_named(
    tmp_path: Path, name: str, content: bytes, says: str
):
    """The message names the file and says what to do."""
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match="a row for each frame, got") as caught:
        read_render_log(path)
    assert says in caught.value.message


def test_fraps_frametimes_are_steps_of_a_clock(tmp_path: Path):
    """``Frame, Time (ms)`` cumulates, so that five rows hold four frames."""
    path = tmp_path / "game 2024 frametimes.csv"
    path.write_text(
        "Frame, Time (ms)\n    1,     0.000\n    2,    16.500\n    3,    33.000\n"
        "    4,    66.000\n    5,    82.500\n",
        encoding="utf-8",
    )
    log = read_render_log(path)
    assert log.format == "fraps"
    assert log.time("frame_ms").tolist() == [16.5, 16.5, 33.0, 16.5]


@pytest.mark.parametrize("headed", [True, False])
def test_mangohud_without_its_system_or_its_header(tmp_path: Path, headed: bool):
    """A log of ``fps,frametime,…`` alone, and one of bare numbers, are still MangoHud's."""
    names = "fps,frametime,cpu_load,gpu_load,cpu_temp,gpu_temp,gpu_core_clock,ram_used,elapsed\n"
    rows = "60,16.6667,20,90,50,60,1800,8,1000000\n50,20,20,90,50,60,1800,8,21000000\n"
    path = tmp_path / "game.csv"
    path.write_text((names if headed else "") + rows, encoding="utf-8")
    log = read_render_log(path)
    assert log.format == "mangohud"
    assert log.time("frame_ms").tolist() == [16.6667, 20.0]
    assert log.time_s is not None
    assert log.time_s.tolist() == [0.001, 0.021]


def test_a_column_of_frame_times_alone_is_a_log(tmp_path: Path):
    """One column needs no separator."""
    path = tmp_path / "times.csv"
    path.write_text("frametime (ms)\n16.5\n17.5\n", encoding="utf-8")
    assert read_render_log(path).time("frame_ms").tolist() == [16.5, 17.5]
