"""Chrome trace events: written, read, and refused."""

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.chrometrace import (
    TraceEvent,
    read_chrome_trace,
    write_chrome_trace,
)

EVENTS = (
    TraceEvent(ph="M", name="thread_name", pid=1, tid=2, args={"name": "GPU"}),
    TraceEvent(ph="X", name="frame 0", cat="frame", ts=0.0, dur=16.667, pid=1, tid=2),
    TraceEvent(ph="B", name="pass", ts=1.0, pid=1, tid=2),
    TraceEvent(ph="E", ts=2.5, pid=1, tid=2),
    TraceEvent(ph="C", name="triangles", ts=3.0, pid=1, args={"triangles": 12.0}),
    TraceEvent(ph="i", name="dropped", ts=4.0, pid=1, tid=3, s="t"),
    TraceEvent(ph="s", name="lag", ts=0.0, pid=1, tid=2, id=7),
    TraceEvent(ph="f", name="lag", ts=9.0, pid=1, tid=3, id=7, bp="e"),
)


def read(tmp_path: Path, content: object) -> tuple[TraceEvent, ...]:
    """Read a file of this content."""
    path = tmp_path / "trace.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_chrome_trace(path)


def test_written_events_come_back(tmp_path: Path) -> None:
    """Every phase is read as it was written."""
    write_chrome_trace(tmp_path / "out.json", EVENTS)
    assert read_chrome_trace(tmp_path / "out.json") == EVENTS


def test_file_is_what_viewers_expect(tmp_path: Path) -> None:
    """An object with traceEvents; microseconds; fields that do not apply are left out."""
    write_chrome_trace(tmp_path / "out.json", iter(EVENTS))
    document = json.loads((tmp_path / "out.json").read_text())
    assert document["displayTimeUnit"] == "ms"
    assert document["traceEvents"][1] == {
        "ph": "X",
        "name": "frame 0",
        "cat": "frame",
        "ts": 0.0,
        "dur": 16.667,
        "pid": 1,
        "tid": 2,
    }
    assert document["traceEvents"][3] == {"ph": "E", "ts": 2.5, "pid": 1, "tid": 2}


def test_no_events(tmp_path: Path) -> None:
    """A trace without events is valid."""
    write_chrome_trace(tmp_path / "out.json", [])
    assert read_chrome_trace(tmp_path / "out.json") == ()


def test_bare_array(tmp_path: Path) -> None:
    """The other form of the format, an array, is read too."""
    assert read(tmp_path, [{"ph": "i", "ts": 1, "name": "x"}]) == (
        TraceEvent(ph="i", ts=1.0, name="x"),
    )


BROKEN: dict[str, tuple[object, str]] = {
    "cut off": (
        '{"traceEvents": [\n{"ph": "i", "ts": 1},\n',
        r"trace\.json:3: expected trace events as ",
    ),
    "other JSON": ({"Runs": []}, "missing required field `traceEvents`"),
    "number": (3, "expected trace events as JSON, got Expected `object | array`"),
    "phase": ([{"ph": "?", "ts": 1}], r"Invalid enum value '\?'"),
    "time": ([{"ph": "i", "name": "x"}], r"event 0 \(x, phase i\): expected a time, got none"),
    "duration": ([{"ph": "X", "ts": 1}], "expected a duration of at least 0, got None"),
    "negative": ([{"ph": "X", "ts": 1, "dur": -2}], "expected a duration of at least 0, got -2.0"),
    "counter": ([{"ph": "C", "ts": 1, "args": {"a": "b"}}], "expected numbers in args"),
    "flow": ([{"ph": "s", "ts": 1}], "expected the id of a flow"),
    "metadata": ([{"ph": "M"}], "expected a name and arguments"),
    "end": ([{"ph": "E", "ts": 1, "pid": 4}], "event 0: expected a begin before an end on pid 4"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_traces_are_refused(tmp_path: Path, name: str) -> None:
    """Each fault is answered by one line that says which event breaks which rule."""
    content, message = BROKEN[name]
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, content)
    assert "\n" not in str(caught.value)


def events_or_refusal(path: Path) -> tuple[TraceEvent, ...] | str:
    """Return what is read, or the message with which it is refused."""
    try:
        return read_chrome_trace(path)
    except InputError as error:
        return error.message


@settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damaged_traces_never_crash(tmp_path: Path, data: st.DataObject) -> None:
    """Whatever characters are replaced, a trace is read or refused."""
    path = tmp_path / "trace.json"
    write_chrome_trace(path, EVENTS)
    content = path.read_text()
    start = data.draw(st.integers(0, len(content)))
    end = data.draw(st.integers(start, min(len(content), start + 20)))
    noise = data.draw(st.text(max_size=6) | st.sampled_from(["[", "}", "null", '"', "1e999"]))
    path.write_bytes((content[:start] + noise + content[end:]).encode("utf-8", "surrogatepass"))
    outcome = events_or_refusal(path)
    if isinstance(outcome, str):
        assert "expected" in outcome
    else:
        assert all(event.ts is not None for event in outcome if event.ph != "M")


@pytest.mark.realdata
def test_real_trace(data_dir: Path) -> None:
    """Perfetto's own test file: eight events, five slices with durations, fields of no use here."""
    events = read_chrome_trace(data_dir / "logs" / "chrometrace-perfetto-flow.json")
    assert [event.ph for event in events] == ["X", "X", "X", "X", "X", "B", "i", "E"]
    assert events[0] == TraceEvent(
        ph="X", name="SenderA", cat="ipc", ts=3002.0, dur=10.0, pid=15902, tid=15903, args={}
    )
