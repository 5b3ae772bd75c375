"""Unity's counters as CSV, whose unit only the values tell."""

from pathlib import Path

import pytest

from lodbench.traces.logs.read_log import read_render_log

HEADER = (
    "CPU Main Thread Frame Time,CPU Render Thread Frame Time,GPU Frame Time,Draw Calls Count,"
    "Batches Count,SetPass Calls Count,Triangles Count,Vertices Count"
)


def log_of(tmp_path: Path, text: str):
    """Read the log of a text, recognised by its content."""
    path = tmp_path / "counters.csv"
    path.write_text(text, encoding="utf-8")
    return read_render_log(path)


@pytest.mark.parametrize("factor", [1, 1_000_000])
def test_nanoseconds_and_milliseconds_give_the_same_log(tmp_path: Path, factor: int):
    """Counters in ns and the FrameTiming struct in ms are told apart by their size."""
    rows = [
        f"{6 * factor},{4 * factor},{9 * factor},120,90,30,80000,90000",
        f"{5 * factor},{7 * factor},{10 * factor},130,95,31,90000,99000",
    ]
    log = log_of(tmp_path, "\n".join([HEADER, *rows]) + "\n")
    assert log.format == "unity"
    assert log.time("gpu_ms").tolist() == [9.0, 10.0]
    assert log.time("cpu_ms").tolist() == [6.0, 7.0]
    assert log.columns(["draw_calls", "state_changes"]).tolist() == [[120, 30], [130, 31]]
    assert any("nanoseconds" in note for note in log.notes) == (factor > 1)


def test_batches_are_left_aside_where_calls_are_counted(tmp_path: Path):
    """Draw calls are Draw Calls Count, and the note says what was not used."""
    log = log_of(tmp_path, f"{HEADER}\n6,4,9,120,90,30,80000,90000\n")
    assert "draw_calls is Draw Calls Count; Batches Count left aside" in log.notes


def test_profile_analyzer_has_times_alone(tmp_path: Path):
    """Its frame CSV is separated by semicolons and starts its clock at the first frame."""
    log = log_of(
        tmp_path,
        "Frame Offset; Frame Index; Frame Time (ms); Time from first frame (ms)\n"
        "0; 1; 16.5; 0\n1; 2; 17.5; 16.5\n",
    )
    assert log.predictors == ()
    assert log.time("frame_ms").tolist() == [16.5, 17.5]
    assert log.time_s is not None
    assert log.time_s.tolist() == [0.0, 0.0165]
