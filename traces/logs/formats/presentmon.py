"""PresentMon CSV in its three dialects, and OCAT's.

- version 1 (``--v1_metrics``, and everything before 2.0): ``msBetweenPresents``, ``Dropped``,
  missing values are 0;
- version 2 (``--v2_metrics``, the default of 2.0 to 2.3.0): ``FrameTime``, ``DisplayLatency``, a
  dropped frame has no ``DisplayedTime``;
- current (the default since 2.3.1): ``MsBetweenPresents``, ``MsBetweenAppStart``, a dropped frame
  has no ``MsUntilDisplayed``.

Columns are found by name, whatever their case and order.  OCAT writes version 1, with columns about
the hardware that only its first row fills.  A file may hold several processes and swap chains: one
is read, the busiest that is neither the compositor ``dwm.exe`` nor swap chain 0x0, or the one asked
for.  Frames that a driver generated (``FrameType``) are left aside and counted.

Source: GameTechDev/PresentMon 2.5.1, README-ConsoleApplication and ``mc/*.cpp``.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ....base.files.text_file import read_encoded
from ..log_format import LogFormat
from ..log_table import LogTable, repeated_headers, split_table
from ..log_timings import log_from_timings
from ..presentmon_clock import CPU_CLOCKS, PRESENT_CLOCKS, present_clock
from ..table_cut import cut_to
from ..timings import FrameTimings, complete_timings

_COLUMNS = {
    "between_presents_ms": ("msbetweenpresents",),
    "frame_ms": ("frametime", "msbetweenappstart"),
    "cpu_busy_ms": ("cpubusy", "mscpubusy"),
    "in_present_ms": ("msinpresentapi", "cpuwait", "mscpuwait"),
    "gpu_latency_ms": ("gpulatency", "msgpulatency"),
    "gpu_time_ms": ("gputime", "msgputime"),
    "gpu_busy_ms": ("gpubusy", "msgpubusy", "msgpuactive"),
    "until_render_start_ms": ("msuntilrenderstart",),
    "until_render_complete_ms": ("msuntilrendercomplete", "msrenderpresentlatency"),
    "until_displayed_ms": ("msuntildisplayed",),
    "display_latency_ms": ("displaylatency",),
    "between_display_change_ms": ("msbetweendisplaychange",),
    "displayed_ms": ("displayedtime",),
    "animation_error_ms": ("animationerror", "msanimationerror"),
    "since_input_ms": ("mssinceinput",),
    "input_to_photon_ms": ("allinputtophotonlatency", "msallinputtophotonlatency"),
    "dropped": ("dropped",),
}
_STREAM = ("application", "processid", "swapchainaddress")
_GENERATED = ("intel", "amd")
_USED = frozenset(
    (
        *(alias for aliases in _COLUMNS.values() for alias in aliases),
        *(*_STREAM, "frametype", *PRESENT_CLOCKS, *CPU_CLOCKS),
    )
)
"""Columns that a row must reach; OCAT's about the hardware, which only its first row has, are not.
"""


def is_presentmon(header: Sequence[str]) -> bool:
    """Return whether these are the columns of one of the dialects."""
    names = {name.lower() for name in header}
    return set(_STREAM) <= names and bool(names & {"msbetweenpresents", "frametime"})


def read_presentmon(
    path: str | Path,
    *,
    application: str | None = None,
    process_id: int | None = None,
    swap_chain: str | None = None,
) -> FrameTimings:
    """Read one stream of a PresentMon or OCAT file.

    Raises `InputError` if the file is no such CSV, a row is broken, there is no such stream, or its
    times decrease.

    Parameters
    ----------
    application, process_id, swap_chain
        Which stream; of those that agree, the busiest.
    """
    table, notes = open_present_table(Path(path))
    wanted = (application, process_id, swap_chain)
    return read_present_table(table, wanted, notes)


def open_present_table(path: Path) -> tuple[LogTable, tuple[str, ...]]:
    """Return the table of a file, and a note if its encoding was unusual; raises InputError."""
    text, encoding = read_encoded(path)
    notes = () if encoding == "UTF-8" else (f"decoded from {encoding}",)
    data = text.replace("\r\n", "\n").replace("\r", "\n").encode()
    table = split_table(data, path)
    line = table.first_line - 1
    if not is_presentmon(table.header):
        message = (
            "expected the columns Application, ProcessID, SwapChainAddress and MsBetweenPresents "
            f"or FrameTime, got {', '.join(table.header)[:80]}; is the header there?"
        )
        raise InputError(message, path=path, line=line)
    if table.delimiter != ",":
        message = f"expected commas between columns, got {table.delimiter!r}; export it with commas"
        raise InputError(message, path=path, line=line)
    twice = [name for name, count in Counter(_names(table)).items() if count > 1]
    if any(name in _USED for name in twice):
        raise InputError(
            f"expected each column once, got {twice[0]} twice; remove one", path=path, line=line
        )
    return table, notes


def _names(table: LogTable) -> list[str]:
    return [name.lower() for name in table.header]


@dataclass(frozen=True, slots=True)
class _Rows:
    """Line, stream and FrameType of every row of one capture."""

    lines: list[int]
    streams: list[tuple[str, ...]]
    generated: list[bool]


def read_present_table(
    table: LogTable,
    wanted: tuple[str | None, int | None, str | None] = (None, None, None),
    notes: tuple[str, ...] = (),
    dialect: str | None = None,
) -> FrameTimings:
    """Return the timings of one stream of a table; raises InputError as `read_presentmon`."""
    again = repeated_headers(table)
    used = [place for place, name in enumerate(_names(table)) if name in _USED]
    table, odd = cut_to(table, used)
    table, appended = _one_capture(table, again)
    rows = _scan(table)
    if not rows.lines:
        message = (
            "expected rows below the header, got none; did the program run during the capture?"
        )
        raise InputError(message, path=table.path, line=table.first_line - 1)
    stream = _choose(rows.streams, wanted, table)
    chosen = [i for i, key in enumerate(rows.streams) if key == stream and not rows.generated[i]]
    if not chosen:
        raise InputError(
            "expected frames of the application, got generated frames only", path=table.path
        )
    known, cells = _numbers(table, chosen)
    lines = [rows.lines[i] for i in chosen]
    clock = present_clock(table, known, chosen, lines)
    timed = np.isfinite(clock)
    known = {name: values[timed] for name, values in (known | {"present_s": clock}).items()}
    untimed = int((~timed).sum())
    lost = (f"{untimed} rows without a time are left aside",) if untimed else ()
    application, process, swap_chain = stream
    made = sum(
        key == stream and made for key, made in zip(rows.streams, rows.generated, strict=True)
    )
    return complete_timings(
        known,
        _dropped(known),
        dialect=dialect or _dialect(table),
        application=application,
        process_id=int(process) if process.isdecimal() else -1,
        swap_chain=swap_chain,
        notes=(*notes, *odd, *appended, *cells, *lost, *_stream_notes(rows, stream, made)),
        generated=made,
    )


def _one_capture(table: LogTable, again: list[int]) -> tuple[LogTable, tuple[str, ...]]:
    """Return the longest capture of a file to which several were appended, each with its header."""
    if not again:
        return table, ()
    lines = table.body.split(b"\n")
    bounds = [0, *(line - table.first_line for line in again), len(lines)]
    starts = range(len(bounds) - 1)
    best = max(starts, key=lambda k: sum(map(bool, lines[bounds[k] : bounds[k + 1]])))
    low, high = bounds[best], bounds[best + 1]
    kept = [text if low <= at < high else b"" for at, text in enumerate(lines)]
    note = f"{len(bounds) - 1} captures in one file; read number {best + 1}, the longest"
    return replace(table, body=b"\n".join(kept)), (note,)


def _scan(table: LogTable) -> _Rows:
    names = _names(table)
    places = [names.index(name) for name in _STREAM]
    frame_type = names.index("frametype") if "frametype" in names else None
    rows = _Rows([], [], [])
    for line, fields in table.rows():
        rows.lines.append(line)
        rows.streams.append(tuple(fields[place].strip() for place in places))
        kind = "" if frame_type is None else fields[frame_type].lower()
        rows.generated.append(kind.startswith(_GENERATED))
    return rows


def _choose(
    streams: Sequence[tuple[str, ...]],
    wanted: tuple[str | None, int | None, str | None],
    table: LogTable,
) -> tuple[str, ...]:
    counts = Counter(streams)
    asked = tuple(None if value is None else str(value).lower() for value in wanted)
    rows_of_stream = {
        key: count
        for key, count in counts.items()
        if all(want is None or want == have.lower() for want, have in zip(asked, key, strict=True))
    }
    if not rows_of_stream:
        sought = " ".join(str(value) for value in wanted if value is not None)
        known = ", ".join(" ".join(key) for key, _ in counts.most_common(5))
        raise InputError(f"expected a stream {sought}, got {known}; name one", path=table.path)
    usual = {key: count for key, count in rows_of_stream.items() if not _is_beside(key)}
    return max((usual or rows_of_stream).items(), key=lambda item: item[1])[0]


def _is_beside(stream: tuple[str, ...]) -> bool:
    """Return whether a stream is the compositor, or presents without a swap chain."""
    application, _, swap_chain = stream
    return application.lower() == "dwm.exe" or not swap_chain.lower().removeprefix("0x").strip("0")


def _stream_notes(rows: _Rows, stream: tuple[str, ...], generated: int) -> tuple[str, ...]:
    notes: list[str] = []
    others = len(set(rows.streams)) - 1
    if others:
        count = rows.streams.count(stream)
        notes.append(
            f"read {' '.join(stream)}, {count} of {len(rows.lines)} rows; {others} other streams"
        )
    if generated:
        notes.append(f"left aside {generated} frames that the driver generated")
    return tuple(notes)


def _numbers(table: LogTable, chosen: list[int]) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    names = _names(table)
    places = {
        raw: names.index(alias)
        for raw, aliases in _COLUMNS.items()
        for alias in reversed(aliases)  # so that the first of those that are there stays
        if alias in names
    }
    values, notes = table.measure(list(places.values()))
    return dict(zip(places, values[chosen].T, strict=True)), notes


def _dropped(known: dict[str, FloatArray]) -> BoolArray:
    """Return which presents were never shown; where Dropped says nothing, by the display's times.

    FrameView writes Error for Dropped where it lost the present's events.
    """
    rows = len(known["present_s"])
    shown = np.ones(rows, dtype=np.bool_)
    for name in ("until_displayed_ms", "displayed_ms"):
        if name in known:
            shown = known[name] > 0.0 if "dropped" in known else ~np.isnan(known[name])
    if "dropped" not in known:
        return ~shown
    return np.where(np.isnan(known["dropped"]), ~shown, known["dropped"] == 1.0)


def _dialect(table: LogTable) -> str:
    names = _names(table)
    if "frametime" in names:
        return "presentmon-v2"
    return "presentmon" if "msbetweenappstart" in names else "presentmon-v1"


FORMAT = LogFormat(
    "PresentMon, OCAT and FrameView; times only",
    lambda head: is_presentmon(head.header),
    lambda path, _: log_from_timings(read_presentmon(path), path.stem),
    predictors=False,
)
