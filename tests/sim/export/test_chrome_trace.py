"""Chrome trace events as they are written."""

import json
from pathlib import Path

import msgspec

from lodbench.sim.export.chrome_trace import TraceEvent, write_chrome_trace

EVENTS = (
    TraceEvent(ph="M", name="thread_name", pid=1, tid=2, args={"name": "GPU"}),
    TraceEvent(ph="X", name="frame 0", cat="frame", ts=0.0, dur=16.667, pid=1, tid=2),
    TraceEvent(ph="C", name="triangles", ts=3.0, pid=1, args={"triangles": 12.0}),
    TraceEvent(ph="i", name="dropped", ts=4.0, pid=1, tid=3, s="t"),
    TraceEvent(ph="s", name="lag", ts=0.0, pid=1, tid=2, id=7),
    TraceEvent(ph="f", name="lag", ts=9.0, pid=1, tid=3, id=7, bp="e"),
)


def test_written_events_come_back(tmp_path: Path) -> None:
    """Every phase is in the file as it was given."""
    write_chrome_trace(tmp_path / "out.json", EVENTS)
    document = json.loads((tmp_path / "out.json").read_text())
    assert msgspec.convert(document["traceEvents"], tuple[TraceEvent, ...]) == EVENTS


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
    flow = {"ph": "s", "name": "lag", "ts": 0.0, "pid": 1, "tid": 2, "id": 7}
    assert document["traceEvents"][4] == flow


def test_no_events(tmp_path: Path) -> None:
    """A trace without events is valid."""
    write_chrome_trace(tmp_path / "out.json", [])
    assert json.loads((tmp_path / "out.json").read_text())["traceEvents"] == []
