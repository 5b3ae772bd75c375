"""Chrome trace events: the JSON that Perfetto, ``chrome://tracing`` and Speedscope open.

An event has a phase: ``X`` a slice with a duration, ``C`` a counter, ``i`` an instant, ``s t f`` a
flow's start, step and end, ``M`` metadata such as a thread's name.  Times are microseconds.

Source: "Trace Event Format", Google, 2016.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import msgspec

from ...base.files.whole_file import whole_text_file

Phase = Literal["X", "C", "i", "s", "t", "f", "M"]


class TraceEvent(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """One event.

    Attributes
    ----------
    ph : phase
    ts, dur : microseconds; ``dur`` is of phase X
    pid, tid : the track
    cat : category, by which viewers filter
    args : what the viewer shows of the event; of phase C the series, of M the name
    id : which flow, of phases s, t and f
    bp : "e" binds a flow's end to the slice around it
    s : scope of an instant: "t" thread, "p" process, "g" all
    """

    ph: Phase
    name: str = ""
    ts: float | None = None
    dur: float | None = None
    pid: int = 0
    tid: int = 0
    cat: str = ""
    args: dict[str, Any] | None = None
    id: int | None = None
    bp: str | None = None
    s: str | None = None


def write_chrome_trace(path: Path, events: Iterable[TraceEvent]) -> None:
    """Write events as an object, one a line.

    Raises `InputError` if the file cannot be written.
    """
    with whole_text_file(path) as file:
        file.write('{"displayTimeUnit":"ms","traceEvents":[')
        for index, event in enumerate(events):
            file.write(",\n" if index else "\n")
            file.write(msgspec.json.encode(event).decode())
        file.write("\n]}\n")
