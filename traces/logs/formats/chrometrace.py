"""Chrome trace events: the JSON that Perfetto, ``chrome://tracing`` and Speedscope open.

An event has a phase: ``X`` a slice with a duration, ``B`` and ``E`` its two ends apart, ``C`` a
counter, ``i`` an instant, ``s t f`` a flow's start, step and end, ``M`` metadata such as a thread's
name.  Times are microseconds.  A file is an array of events or an object that holds one.

Source: "Trace Event Format", Google, 2016.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Literal

import msgspec

from ....base.errors import InputError
from ....base.strict_json import read_json
from ....base.whole_file import whole_text_file

_ADVICE = "give a file of Chrome trace events"

# fmt: off
Phase = Literal[
    "X", "B", "E", "C", "i", "I", "s", "t", "f", "M",
    "b", "n", "e", "N", "O", "D", "P", "R",  # asynchronous, object, sample and mark: kept as read
]
# fmt: on


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
    pid: int | str = 0
    tid: int | str = 0
    cat: str = ""
    args: dict[str, Any] | None = None
    id: int | str | None = None
    bp: str | None = None
    s: str | None = None


class _Document(msgspec.Struct, rename="camel"):
    trace_events: list[TraceEvent]
    display_time_unit: Literal["ms", "ns"] = "ms"


_FORMS: Any = _Document | list[TraceEvent]


def read_chrome_trace(path: str | Path) -> tuple[TraceEvent, ...]:
    """Read the events of a file, in its order.

    Raises `InputError` if the file is not JSON of this form, or an event breaks the rules of its
    phase: a time in each but metadata, a duration of at least 0 in a slice, numbers in a counter,
    an id in a flow, an end for each begin.
    """
    source = Path(path)
    content: _Document | list[TraceEvent] = read_json(source, _FORMS, "trace events", _ADVICE)
    events = content if isinstance(content, list) else content.trace_events
    for index, event in enumerate(events):
        wrong = _fault(event)
        if wrong:
            raise InputError(
                f"event {index} ({event.name[:40]}, phase {event.ph}): expected {wrong}; {_ADVICE}",
                path=path,
            )
    _require_ends(events, source)
    return tuple(events)


def _fault(event: TraceEvent) -> str:
    """Return what an event should have and has not, or ''."""
    if event.ph == "M":
        return "" if event.name and event.args else "a name and arguments, got none"
    if event.ts is None:
        return "a time, got none"
    if event.ph == "X" and (event.dur is None or event.dur < 0.0):
        return f"a duration of at least 0, got {event.dur}"
    if event.ph == "C" and not _is_series(event.args):
        return "numbers in args, got something else"
    if event.ph in {"s", "t", "f"} and event.id is None:
        return "the id of a flow, got none"
    return ""


def _is_series(args: dict[str, Any] | None) -> bool:
    return bool(args) and all(isinstance(value, int | float) for value in args.values())


def _require_ends(events: Sequence[TraceEvent], path: Path) -> None:
    depth: dict[tuple[int | str, int | str], int] = {}
    for index, event in enumerate(events):
        track = (event.pid, event.tid)
        if event.ph == "B":
            depth[track] = depth.get(track, 0) + 1
        elif event.ph == "E":
            depth[track] = depth.get(track, 0) - 1
            if depth[track] < 0:
                raise InputError(
                    f"event {index}: expected a begin before an end on pid {event.pid} tid "
                    f"{event.tid}, got none; {_ADVICE}",
                    path=path,
                )


def write_chrome_trace(path: str | Path, events: Iterable[TraceEvent]) -> None:
    """Write events as an object, one a line.

    Raises `InputError` if the file cannot be written.
    """
    with whole_text_file(Path(path)) as file:
        file.write('{"displayTimeUnit":"ms","traceEvents":[')
        for index, event in enumerate(events):
            file.write(",\n" if index else "\n")
            file.write(msgspec.json.encode(event).decode())
        file.write("\n]}\n")
