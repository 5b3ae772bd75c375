"""PresentMon CSV as written: read back, and as PresentMon itself writes it."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.presentmon import read_presentmon
from lodbench.traces.logs.presentmon_writer import write_presentmon
from lodbench.traces.logs.timings import FrameTimings, complete_timings


@pytest.fixture
def timings(tmp_path: Path, present_logs: dict[str, str]) -> FrameTimings:
    """Return the hand-worked stream."""
    path = tmp_path / "given.csv"
    path.write_text(present_logs["presentmon"])
    return read_presentmon(path)


def test_hand_worked_stream_comes_back(
    tmp_path: Path, timings: FrameTimings, expected_timings: dict[str, list[float]]
) -> None:
    """Every column and the stream are read as they were written."""
    write_presentmon(tmp_path / "out.csv", timings)
    again = read_presentmon(tmp_path / "out.csv")
    assert (again.application, again.process_id, again.swap_chain) == ("game.exe", 7, "0xABC")
    assert again.dropped.tolist() == timings.dropped.tolist()
    for name, values in expected_timings.items():
        assert getattr(again, name) == pytest.approx(values, abs=1e-6, nan_ok=True), name


def test_row_as_presentmon_writes_it(tmp_path: Path, timings: FrameTimings) -> None:
    """A row's columns hold what the definitions say, NA what a dropped frame cannot have."""
    write_presentmon(tmp_path / "out.csv", timings, sync_interval=1, tearing=True)
    with (tmp_path / "out.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    third = rows[2]
    assert third["TimeInSeconds"] == "0.022000000"
    assert third["CPUStartTimeInSeconds"] == "0.018000000"
    assert third["MsGPUWait"] == "2.000000"
    assert third["MsRenderPresentLatency"] == "5.000000"
    assert third["AnimationTime"] == "18.000000"
    assert (third["SyncInterval"], third["AllowsTearing"]) == ("1", "1")
    missing = {name for name, value in rows[1].items() if value == "NA"}
    assert missing - {name for name, value in third.items() if value == "NA"} == {
        "MsBetweenDisplayChange",
        "MsUntilDisplayed",
        "MsAnimationError",
        "AnimationTime",
    }


@pytest.mark.realdata
def test_columns_are_those_of_the_real_dialect(
    tmp_path: Path, data_dir: Path, timings: FrameTimings
) -> None:
    """The header is the real one in its order, without the columns of extra trackers."""
    write_presentmon(tmp_path / "out.csv", timings)
    written = (tmp_path / "out.csv").read_text().partition("\n")[0].split(",")
    path = data_dir / "logs" / "presentmon-v2-default.csv"
    real = path.read_text(encoding="utf-8-sig").partition("\n")[0].split(",")
    extra = {"FrameType", "MsPCLatency", "MsVideoBusy", "MsInstrumentedLatency"}
    units = {"TimeInQPC": "TimeInSeconds", "CPUStartQPC": "CPUStartTimeInSeconds"}
    assert written == [units.get(name, name) for name in real if name not in extra]


@pytest.mark.realdata
@pytest.mark.parametrize("name", ["presentmon-v1.csv", "presentmon-v2.csv", "ocat-metroexodus.csv"])
def test_real_logs_can_be_turned_into_the_current_dialect(
    tmp_path: Path, data_dir: Path, name: str, expected_timings: dict[str, list[float]]
) -> None:
    """A log of another dialect, written in the current one, keeps all that it said."""
    given_log = read_presentmon(data_dir / "logs" / name)
    write_presentmon(tmp_path / "out.csv", given_log)
    again = read_presentmon(tmp_path / "out.csv")
    assert again.dialect == "presentmon"
    for column in expected_timings:
        before, after = getattr(given_log, column), getattr(again, column)
        known = np.isfinite(before)
        known[-1] &= column != "displayed_ms"  # which only version 2 has of the last frame
        assert after[known] == pytest.approx(before[known], abs=2e-6), column


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    steps=st.lists(
        st.tuples(*[st.integers(1, 50_000_000)] * 4, st.booleans()), min_size=1, max_size=20
    )
)
def test_any_timeline_comes_back_to_the_nanosecond(
    tmp_path: Path, steps: list[tuple[int, int, int, int, bool]]
) -> None:
    """Timings in whole nanoseconds are read back exactly, derived ones to the last bits."""
    busy, wait, gpu, until, dropped = (np.array(column) for column in zip(*steps, strict=True))
    start = np.concatenate([[0], np.cumsum(busy + wait)[:-1]])
    present = start + busy
    between = np.diff(present, prepend=0) / 1e6
    made = complete_timings(
        {
            "present_s": present / 1e9,
            "between_presents_ms": between,
            "cpu_busy_ms": busy / 1e6,
            "in_present_ms": wait / 1e6,
            "gpu_latency_ms": busy / 1e6,
            "gpu_time_ms": gpu / 1e6,
            "gpu_busy_ms": gpu / 1e6,
            "until_displayed_ms": (gpu + until) / 1e6,
        },
        dropped,
        dialect="simulated",
        application='a, "b"',
        process_id=1,
        swap_chain="0x1",
    )
    write_presentmon(tmp_path / "out.csv", made)
    again = read_presentmon(tmp_path / "out.csv")
    assert again.application == made.application
    assert again.present_s.tolist() == made.present_s.tolist()
    for name in ("between_presents_ms", "cpu_busy_ms", "in_present_ms", "gpu_busy_ms"):
        assert getattr(again, name).tolist() == getattr(made, name).tolist()
    for name in ("display_latency_ms", "displayed_ms", "frame_ms", "gpu_latency_ms"):
        expected = getattr(made, name)
        assert getattr(again, name) == pytest.approx(expected, abs=1.1e-6, nan_ok=True)


def test_nothing_half_written(tmp_path: Path, timings: FrameTimings) -> None:
    """A file that cannot be written is bad output, and no part of it stays."""
    with pytest.raises(InputError, match="expected a path that can be written"):
        write_presentmon(tmp_path / "none" / "out.csv", timings)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match="expected a file, got a folder"):
        write_presentmon(tmp_path / "folder.csv", timings)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.csv", "given.csv"]
