"""CapFrameX: JSON and CSV, what is written and read, and broken files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.capframex import read_capframex, write_capframex
from lodbench.traces.logs.formats.presentmon import read_presentmon
from lodbench.traces.logs.timings import FrameTimings

# As CapFrameX saves: fields that it may leave null, integers among floats, NaN as a string.
CAPTURE: dict[str, Any] = {
    "TimeInSeconds": [0.009, 0.015, 0.022, 0.030],
    "MsBetweenPresents": [5, 6.0, 7.0, 8.0],
    "MsInPresentAPI": [3.0, 3.0, 3.0, 2.0],
    "MsBetweenDisplayChange": [10.0, 0.0, 10.0, 15.0],
    "MsUntilRenderComplete": [7.0, 4.0, 5.0, 8.0],
    "MsUntilDisplayed": [11.0, 0.0, 8.0, 15.0],
    "QPCTime": [0.0, 0.0, 0.0, 0.0],
    "PresentMode": [4, 4, 4, 4],
    "AllowsTearing": [0, 0, 0, 0],
    "SyncInterval": [0, 0, 0, 0],
    "Dropped": [False, True, False, False],
    "PcLatency": None,
    "AnimationError": [-5.0, "NaN", 3.0, -8.0],
    "GpuActive": [7.0, 3.0, 5.0, 8.0],
    "CpuActive": [4.0, 3.0, 4.0, 5.0],
}
Timings = dict[str, list[float]]
UNKNOWN = {"gpu_latency_ms", "gpu_time_ms", "input_to_photon_ms"}


def session(*captures: dict[str, Any]) -> dict[str, Any]:
    """Return a record with these runs."""
    runs = [{"Hash": "0", "CaptureData": capture, "SensorData2": None} for capture in captures]
    info = {"ProcessName": "game.exe", "GPU": "RTX", "Comment": None, "ResizableBar": "On"}
    return {"Hash": "1", "Info": info, "Runs": runs}


def read(tmp_path: Path, content: object, **run: int) -> FrameTimings:
    """Read a file of this content."""
    path = tmp_path / "record.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_capframex(path, **run)


@pytest.fixture
def made(tmp_path: Path, present_logs: dict[str, str]) -> FrameTimings:
    """Return the hand-worked stream."""
    source = tmp_path / "given.csv"
    source.write_text(present_logs["presentmon"])
    return read_presentmon(source)


def test_json_gives_the_hand_worked_timings(tmp_path: Path, expected_timings: Timings) -> None:
    """Each column that CapFrameX has, or that follows from those, reads as worked by hand."""
    timings = read(tmp_path, session(CAPTURE))
    assert (timings.dialect, timings.application) == ("capframex", "game.exe")
    assert timings.header == (("ProcessName", "game.exe"), ("GPU", "RTX"))
    for name in expected_timings.keys() - UNKNOWN:
        assert getattr(timings, name) == pytest.approx(expected_timings[name], nan_ok=True), name
    for name in UNKNOWN:
        assert np.isnan(getattr(timings, name)).all()


def test_older_records_lack_columns(tmp_path: Path) -> None:
    """With the three columns of the oldest records, intervals are read and busy times are not."""
    oldest = {name: CAPTURE[name] for name in ("TimeInSeconds", "MsBetweenPresents", "Dropped")}
    timings = read(tmp_path, session(oldest))
    assert timings.between_presents_ms.tolist() == [5, 6, 7, 8]
    assert np.isnan(timings.cpu_busy_ms).all()


def test_runs_are_separate(tmp_path: Path) -> None:
    """One run of several is read, the first unless asked, and it is said."""
    short = {name: value and value[:2] for name, value in CAPTURE.items()}
    timings = read(tmp_path, session(CAPTURE, short))
    assert (len(timings), timings.notes) == (4, ("read run 0 of 2",))
    assert len(read(tmp_path, session(CAPTURE, short), run=1)) == 2
    with pytest.raises(InputError, match="expected a run from 0 to 1, got 2"):
        read(tmp_path, session(CAPTURE, short), run=2)


def test_csv_with_header_lines(tmp_path: Path, present_logs: dict[str, str]) -> None:
    """Lines //Key=Value become the header; the rest reads as OCAT's columns do."""
    content = "//GameName=game.exe\n//GPU #=1\n//Comment=a=b\n" + present_logs["presentmon-v1"]
    timings = read(tmp_path, content)
    assert timings.dialect == "capframex"
    assert timings.header == (("GameName", "game.exe"), ("GPU #", "1"), ("Comment", "a=b"))
    assert timings.gpu_busy_ms.tolist() == [7, 3, 5, 8]
    assert len(read(tmp_path, content.replace(",0,0.022,3", ",0,0.022"))) == 3
    with pytest.raises(InputError, match="expected run 0"):
        read(tmp_path, content, run=1)


def test_written_record_comes_back(
    tmp_path: Path, made: FrameTimings, expected_timings: Timings
) -> None:
    """All that CapFrameX has a place for is read back; time starts at 0."""
    write_capframex(tmp_path / "out.json", made, comment="as written")
    again = read_capframex(tmp_path / "out.json")
    assert again.dropped.tolist() == made.dropped.tolist()
    assert again.present_s == pytest.approx(made.present_s - 0.009, abs=1e-12)
    assert ("Comment", "as written") in again.header
    for name in expected_timings.keys() - UNKNOWN - {"present_s"}:
        assert getattr(again, name) == pytest.approx(expected_timings[name], nan_ok=True), name


def test_written_record_has_the_fields_of_a_real_one(tmp_path: Path, made: FrameTimings) -> None:
    """Zeros stand for a dropped frame's display times, "NaN" for other numbers that are none."""
    write_capframex(tmp_path / "out.json", made, tearing=True)
    record = json.loads((tmp_path / "out.json").read_text())
    capture = record["Runs"][0]["CaptureData"]
    assert set(capture) == set(CAPTURE) - {"QPCTime", "PcLatency"}
    assert capture["MsUntilDisplayed"] == [11, 0, 8, 15]
    assert capture["AnimationError"] == [-5, "NaN", 3, -8]
    assert capture["AllowsTearing"] == [1] * 4
    write_capframex(tmp_path / "again.json", made, tearing=True)
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "out.json").read_bytes()


def changed(**columns: object) -> dict[str, Any]:
    """Return a record with some columns of its capture replaced."""
    return session({**CAPTURE, **columns})


BROKEN: dict[str, tuple[object, str]] = {
    "cut off": (
        json.dumps(session(CAPTURE), indent=1)[:-40],
        r":\d+: expected a record of ",
    ),
    "no runs": ({"Info": None, "Runs": []}, "expected a run from 0 to -1"),
    "other JSON": ({"traceEvents": []}, "missing required field `Runs`"),
    "lengths": (changed(CpuActive=[1.0]), "expected 4 values of cpu_busy_ms as of time, got 1"),
    "no dropped": (changed(Dropped=[True]), "expected 4 values of dropped"),
    "text": (changed(MsInPresentAPI=["3,0"] * 4), r"Runs\[0\].CaptureData.MsInPresentAPI\[0\]"),
    "backward": (changed(TimeInSeconds=[0, 2, 1, 3]), "never decrease, got 1.0 at frame 2"),
    "no time": (changed(TimeInSeconds=["NaN"] * 4), "never decrease, got nan at frame"),
    "infinite": (json.dumps(changed()).replace("15.0", "1e999"), "Number out of range"),
    "nothing": (changed(TimeInSeconds=[]), "expected at least one frame, got none"),
    "bare NaN": (
        json.dumps(changed(GpuActive=[float("nan")] * 4)),
        "character at 'NaN",
    ),
    "deep": ('{"a":' * 100_000, "got brackets nested too deep"),
    "long number": ('{"Runs":' + "1" * 5000 + "}", "expected a record"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_records_are_refused(tmp_path: Path, name: str) -> None:
    """Each fault is answered by one line that says where it is."""
    content, message = BROKEN[name]
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, content)
    assert "\n" not in str(caught.value)


def timings_or_refusal(path: Path) -> FrameTimings | str:
    """Return what is read, or the message with which it is refused."""
    try:
        return read_capframex(path)
    except InputError as error:
        return error.message


@settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damaged_records_never_crash(tmp_path: Path, data: st.DataObject) -> None:
    """Whatever characters are replaced, a record is read or refused."""
    content = json.dumps(session(CAPTURE))
    start = data.draw(st.integers(0, len(content)))
    noise = data.draw(st.text(max_size=6) | st.sampled_from(["[", "]", "null", "1e999", '"NaN"']))
    end = data.draw(st.integers(start, min(len(content), start + 20)))
    path = tmp_path / "record.json"
    damaged = content[:start] + noise + content[end:]
    path.write_bytes(damaged.encode("utf-8", "surrogatepass"))
    outcome = timings_or_refusal(path)
    if isinstance(outcome, str):
        assert "expected" in outcome
    else:
        assert np.all(np.diff(outcome.present_s) >= 0.0)


@pytest.mark.realdata
def test_real_csv(data_dir: Path) -> None:
    """Seventeen header lines and 7,285 presents in 25.4 s, of which 4,236 were dropped."""
    timings = read_capframex(data_dir / "logs" / "capframex-with-header.csv")
    assert len(timings) == 7285
    assert np.count_nonzero(timings.dropped) == 4236
    assert timings.application == "re2.exe"
    assert len(timings.header) == 17
    assert dict(timings.header)["ProcessName"] == "Resident Evil 2 Remake"
    assert timings.present_s[-1] == pytest.approx(25.43982)
    shown_ms = np.nansum(timings.between_display_change_ms)
    assert shown_ms == pytest.approx(25_440, abs=30)
