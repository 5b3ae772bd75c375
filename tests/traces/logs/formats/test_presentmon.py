"""PresentMon and OCAT: a hand-worked stream in three dialects, and broken files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.presentmon import read_presentmon
from lodbench.traces.logs.timings import FrameTimings

DIALECTS = ("presentmon-v1", "presentmon-v2", "presentmon")
NAN = float("nan")
Timings = dict[str, list[float]]


def read(tmp_path: Path, content: str | bytes, **stream: Any) -> FrameTimings:
    """Read a file of this content."""
    path = tmp_path / "log.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_presentmon(path, **stream)


def refusal(tmp_path: Path, content: str | bytes, **stream: Any) -> str:
    """Return the one line with which a file of this content is refused, from its line number on."""
    with pytest.raises(InputError) as caught:
        read(tmp_path, content, **stream)
    message = str(caught.value).removeprefix(f"{tmp_path / 'log.csv'}:")
    assert "\n" not in message
    return message


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_give_the_same_timings(
    tmp_path: Path, dialect: str, present_logs: dict[str, str], expected_timings: Timings
) -> None:
    """One stream in each dialect reads as worked by hand, but for what the dialect lacks."""
    timings = read(tmp_path, present_logs[dialect])
    assert timings.dialect == dialect
    assert (timings.application, timings.process_id, timings.swap_chain) == ("game.exe", 7, "0xABC")
    assert timings.dropped.tolist() == [False, True, False, False]
    expected = expected_timings
    if dialect == "presentmon-v1":
        # Of the first row nothing is known of the Present() before, by which CPUStart is defined.
        for name in ("cpu_busy_ms", "frame_ms", "gpu_latency_ms", "display_latency_ms"):
            expected[name][0] = NAN
        expected["animation_error_ms"] = [NAN] * 4
    if dialect == "presentmon-v2":
        expected["between_presents_ms"][0] = expected["between_display_change_ms"][0] = NAN
        # DisplayedTime of the last frame is in the file here.
        expected["displayed_ms"][3] = 10
    for name, values in expected.items():
        assert getattr(timings, name) == pytest.approx(values, abs=1e-9, nan_ok=True), name


def test_arrays_are_read_only(tmp_path: Path, present_logs: dict[str, str]) -> None:
    """Timings cannot be changed after the checks of construction."""
    with pytest.raises(ValueError, match="read-only"):
        read(tmp_path, present_logs["presentmon-v1"]).frame_ms[0] = 1.0


def test_presents_that_are_missing_break_the_chain(
    tmp_path: Path, present_logs: dict[str, str]
) -> None:
    """Without the dropped row (--exclude_dropped), nothing is derived from the row before it."""
    lines = present_logs["presentmon-v1"].splitlines(keepends=True)
    timings = read(tmp_path, "".join(lines[:2] + lines[3:]))
    assert timings.cpu_busy_ms == pytest.approx([NAN, NAN, 5.0], nan_ok=True)
    assert timings.between_presents_ms.tolist() == [5.0, 7.0, 8.0]


@pytest.mark.parametrize(
    ("column", "times"),
    [
        ("CPUStartQPC", [1_000_050_000, 1_000_120_000, 1_000_180_000, 1_000_250_000]),
        ("CPUStartQPC", [24_120_000, 24_288_000, 24_432_000, 24_600_000]),  # 24 MHz
        ("CPUStartTimeInSeconds", [0.005, 0.012, 0.018, 0.025]),
        ("CPUStartDateTime", [f"2026-9-8 8:57:43.0{ms:02d}000000" for ms in (5, 12, 18, 25)]),
    ],
)
def test_clocks(
    tmp_path: Path, column: str, times: list[object], present_logs: dict[str, str]
) -> None:
    """Ticks of any frequency, seconds and dates give the same steps of Present()."""
    lines = present_logs["presentmon-v2"].replace("CPUStartTime", column).splitlines()
    for row, time in enumerate(times, start=1):
        fields = lines[row].split(",")
        fields[9] = str(time)
        lines[row] = ",".join(fields)
    timings = read(tmp_path, "\n".join(lines))
    assert np.diff(timings.present_s) * 1e3 == pytest.approx([6, 7, 8], abs=1e-6)
    assert timings.between_presents_ms[1:] == pytest.approx([6, 7, 8])


def test_version_1_with_dates_in_seconds_column(
    tmp_path: Path, present_logs: dict[str, str]
) -> None:
    """With -date_time, version 1 writes dates under TimeInSeconds."""
    content = present_logs["presentmon-v1"]
    for second in ("0.009", "0.015", "0.022", "0.030"):
        content = content.replace(f",{second},", f",2021-1-2 23:59:5{second}000000,")
    content = content.replace("59:50.", "59:59.")
    assert np.diff(read(tmp_path, content).present_s) == pytest.approx([0.006, 0.007, 0.008])


def stream(application: str, process_id: int, swap_chain: str, rows: int) -> str:
    """Return rows of version 1 of one stream."""
    return "".join(
        f"{application},{process_id},{swap_chain},DXGI,0,0,0,Other,0,{k / 100},1,10,1,12,10,0,1,0\n"
        for k in range(rows)
    )


def test_busiest_stream_is_read(tmp_path: Path, present_logs: dict[str, str]) -> None:
    """Default: the most rows, without compositor and swap chain 0x0; each can be asked for."""
    header = present_logs["presentmon-v1"].splitlines(keepends=True)[0]
    content = (
        header
        + stream("dwm.exe", 1, "0x10", 9)
        + stream("game.exe", 2, "0x0000", 8)
        + stream("game.exe", 2, "0x20", 3)
        + stream("game.exe", 2, "0x21", 5)
        + stream("tool.exe", 3, "0x30", 4)
    )
    chosen = read(tmp_path, content)
    assert (chosen.swap_chain, len(chosen)) == ("0x21", 5)
    assert chosen.notes == ("read game.exe 2 0x21, 5 of 29 rows; 4 other streams",)
    assert len(read(tmp_path, content, application="DWM.exe")) == 9
    assert len(read(tmp_path, content, process_id=3)) == 4
    assert len(read(tmp_path, content, process_id=2, swap_chain="0x0000")) == 8
    message = refusal(tmp_path, content, application="other.exe")
    assert message.startswith(" expected a stream other.exe, got dwm.exe 1 0x10")


def test_only_the_compositor(tmp_path: Path, present_logs: dict[str, str]) -> None:
    """A file of nothing but the compositor is read."""
    header = present_logs["presentmon-v1"].splitlines(keepends=True)[0]
    content = header + stream("dwm.exe", 1, "0x10", 2)
    assert read(tmp_path, content).application == "dwm.exe"


def test_generated_frames_are_left_aside(
    tmp_path: Path, present_logs: dict[str, str], expected_timings: Timings
) -> None:
    """A frame that the driver made up between two others is no frame of the application."""
    lines = present_logs["presentmon-v2"].splitlines()
    lines.insert(3, lines[2].replace("Application,12", "Intel XeSS-FG,12"))
    timings = read(tmp_path, "\n".join(lines))
    assert timings.frame_ms == pytest.approx(expected_timings["frame_ms"])
    assert timings.notes == ("left aside 1 frames that the driver generated",)


VARIANTS: dict[str, Callable[[str], bytes]] = {
    "UTF-8 with mark": lambda log: b"\xef\xbb\xbf" + log.encode(),
    "Windows line ends": lambda log: log.replace("\n", "\r\n").encode(),
    "mixed line ends": lambda log: log.replace("\n", "\r\n", 2).encode(),
    "blank last lines": lambda log: log.encode() + b"\n\n",
    "other case": lambda log: log.replace("MsBetweenPresents", "msBetweenPresents").encode(),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_harmless_variants(
    tmp_path: Path, name: str, present_logs: dict[str, str], expected_timings: Timings
) -> None:
    """Marks, line ends, blank lines and the case of names change nothing."""
    timings = read(tmp_path, VARIANTS[name](present_logs["presentmon"]))
    expected = expected_timings["display_latency_ms"]
    assert timings.display_latency_ms == pytest.approx(expected, nan_ok=True)
    assert timings.notes == ()


def test_redirected_in_powershell(
    tmp_path: Path, present_logs: dict[str, str], expected_timings: Timings
) -> None:
    """UTF-16LE is decoded, and said."""
    log = present_logs["presentmon"].replace("\n", "\r\n")
    timings = read(tmp_path, b"\xff\xfe" + log.encode("utf-16-le"))
    assert timings.frame_ms == pytest.approx(expected_timings["frame_ms"])
    assert timings.notes == ("decoded from UTF-16LE",)


def test_ocat_first_row_has_more_columns(tmp_path: Path, present_logs: dict[str, str]) -> None:
    """The columns about the hardware, filled in the first row only, do not hide a truncated row."""
    lines = present_logs["presentmon-v1"].splitlines()
    lines[0] += ",Motherboard,OS,Comment"
    lines[1] += ',"Maker, Inc.",Windows,'
    timings = read(tmp_path, "\n".join(lines))
    assert timings.gpu_busy_ms.tolist() == [7, 3, 5, 8]
    lines[3] = lines[3].rsplit(",", 2)[0]
    timings = read(tmp_path, "\n".join(lines))
    assert len(timings) == 3
    assert "1 of 4 rows lack columns" in timings.notes[0]


BROKEN: dict[str, tuple[Callable[[str], str | bytes], str]] = {
    "semicolons": (
        lambda log: log.replace(",", ";"),
        "1: expected commas between columns, got ';'",
    ),
    "tabs": (lambda log: log.replace(",", "\t"), "1: expected commas between columns"),
    "decimal commas": (
        lambda log: log.replace(".0", ",0"),
        "2: expected 18 columns as in the header, got 19; decimal commas",
    ),
    "no header": (
        lambda log: log.partition("\n")[2],
        "1: expected the columns Application, ProcessID",
    ),
    "another file": (lambda _: "a,b\n1,2\n", "1: expected the columns Application, ProcessID"),
    "column twice": (
        lambda log: log.replace("msGPUActive", "DROPPED"),
        "1: expected each column once, got dropped twice",
    ),
    "no rows": (lambda log: log.partition("\n")[0], "1: expected rows below the header, got none"),
    "empty": (lambda _: "", " expected text, got an empty file"),
    "binary": (lambda _: b"\x89PNG\r\n\x1a\n\0\0", "1: expected UTF-8 text, got byte 0x89"),
    "zero byte": (lambda log: log.replace("game", "ga\0e", 1), "2: expected text, got a zero byte"),
    "unmarked UTF-16": (lambda log: log.encode("utf-16-le"), "1: expected text, got a zero byte"),
    "cut UTF-16": (
        lambda log: b"\xff\xfe" + log.encode("utf-16-le")[:-1],
        "expected UTF-16LE text",
    ),
    "unsorted": (
        lambda log: log.replace("0.022", "0.002"),
        "4: expected times that never decrease, got 0.002",
    ),
    "no clock": (
        lambda log: log.replace("TimeInSeconds", "Time"),
        "1: expected a column with the time",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused(tmp_path: Path, name: str, present_logs: dict[str, str]) -> None:
    """Each fault is answered by one line that says where it is and what was expected."""
    damage, start = BROKEN[name]
    assert start in refusal(tmp_path, damage(present_logs["presentmon-v1"]))


ODD: dict[str, tuple[Callable[[str], str], int, str]] = {
    "truncated": (lambda log: log[:-12], 3, "1 of 4 rows lack columns"),
    "no number": (
        lambda log: log.replace(",0,0.022,3", ",0,0.022,three"),
        4,
        "1 cell of msInPresentAPI is no number, such as 'three'",
    ),
    "infinite": (lambda log: log.replace(",0,0.022,3", ",0,0.022,inf"), 4, "such as 'inf'"),
    "no time": (lambda log: log.replace("0.022", "NA"), 3, "1 rows without a time"),
    "open quote": (lambda log: log.replace("game.exe", '"game.exe', 1), 3, "1 of 4 rows lack"),
    "appended": (lambda log: log + log, 4, "2 captures in one file; read number 1"),
    "Dropped lost": (lambda log: log.replace(",1,0.015", ",Error,0.015"), 4, "such as 'Error'"),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_rows_are_left_aside_and_counted(
    tmp_path: Path, name: str, present_logs: dict[str, str]
) -> None:
    """A row that cannot serve costs itself alone, and is told of."""
    damage, rows, says = ODD[name]
    timings = read(tmp_path, damage(present_logs["presentmon-v1"]))
    assert len(timings) == rows
    assert any(says in note for note in timings.notes), timings.notes


def test_missing_file(tmp_path: Path) -> None:
    """A file that is not there is bad input."""
    with pytest.raises(InputError, match=r"expected a file that can be read, got No such file"):
        read_presentmon(tmp_path / "none.csv")


def timings_or_refusal(tmp_path: Path, content: bytes) -> FrameTimings | str:
    """Return what is read, or the message with which it is refused."""
    try:
        return read(tmp_path, content)
    except InputError as error:
        return error.message


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data(), dialect=st.sampled_from(DIALECTS))
def test_damaged_files_never_crash(
    tmp_path: Path, present_logs: dict[str, str], data: st.DataObject, dialect: str
) -> None:
    """Whatever bytes are replaced, a file is read or refused, and what is read is consistent."""
    content = present_logs[dialect].encode()
    start = data.draw(st.integers(0, len(content)))
    end = data.draw(st.integers(start, min(len(content), start + 40)))
    noise = data.draw(
        st.binary(max_size=8) | st.sampled_from([b",", b"\n", b'"', b"NA", b"-1e999"])
    )
    outcome = timings_or_refusal(tmp_path, content[:start] + noise + content[end:])
    if isinstance(outcome, str):
        assert "expected" in outcome
    else:
        assert np.all(np.diff(outcome.present_s) >= 0.0)
        assert np.all(np.isnan(outcome.display_latency_ms[outcome.dropped]))
