"""CSV captures of Unreal's CSV profiler (``csvprofile start``).

Column 0 is ``EVENTS``, then one column per stat in the order in which stats first appeared, so rows
grow wider down the file.  A finished capture ends in the complete header and a row of metadata,
``[HasHeaderRowAtEnd],1,[platform],…,[commandline],…``; older ones have the metadata row alone.
Times are milliseconds.  ``cpu_ms`` is the longest of the game, render and RHI threads, which work
on successive frames side by side.

Layout as in Unreal 4.19 to 5.5; written from files, not from the engine's source.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ....base.errors import InputError
from ..log_format import Columns, LogFormat, LogHead
from ..log_table import LogTable, read_log_bytes, split_table
from ..render_log import RenderLog
from .log_csv import log_of_table

_THREADS = ("GameThreadTime", "RenderThreadTime")
_AT_END = "HasHeaderRowAtEnd"
_EVENTS = "EVENTS"


def read_unreal_csv(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log of a capture; mapped columns go before the usual ones.

    Raises `InputError` if the file has no rows, no known time, or no number where one is expected.
    """
    capture = _split(read_log_bytes(path), path)
    return log_of_table(
        capture.table,
        mapping,
        "unreal",
        unit="ms",
        twins=True,
        header=capture.metadata,
        notes=(*capture.notes, *_unseen(capture.table.header)),
    )


@dataclass(frozen=True, slots=True)
class _Capture:
    table: LogTable
    metadata: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def _split(data: bytes, path: Path) -> _Capture:
    """Take the header and metadata at the end off the rows."""
    whole = data.endswith(b"\n")
    first = split_table(data, path)
    rows = first.body.rstrip(b"\n").split(b"\n")
    metadata: tuple[tuple[str, str], ...] = ()
    notes: list[str] = []
    header = first.header
    if rows[-1].startswith(b"["):
        metadata = _metadata(rows.pop().decode("utf-8"))
    elif not whole and len(rows) > 1:
        rows.pop()
        notes.append("the last row is cut off and left aside")
    if dict(metadata).get(_AT_END.lower()) == "1":
        if not rows or not rows[-1].startswith(_EVENTS.encode()):
            line = first.first_line + len(rows)
            message = f"expected the header before the metadata, as [{_AT_END}] says, got a row"
            raise InputError(f"{message}; record the capture again", path=path, line=line)
        header = tuple(name.strip() for name in rows.pop().decode("utf-8").split(first.delimiter))
    else:
        notes.append(
            "no header at the end: the capture did not finish, or Unreal is older than 4.23"
        )
    body = b"\n".join(rows) + b"\n" if rows else b""
    table = LogTable(path, header, (), first.delimiter, body, first.first_line, ragged=True)
    return _Capture(table, metadata, tuple(notes))


def _metadata(row: str) -> tuple[tuple[str, str], ...]:
    """Return pairs of ``[key],value`` fields; a value, such as a command line, may hold commas."""
    parts = re.split(r"(?:^|,)\[(\w+)\],", row)
    return tuple(zip((key.lower() for key in parts[1::2]), parts[2::2], strict=True))


def _unseen(header: Sequence[str]) -> list[str]:
    if not any("Nanite" in name for name in header):
        return []
    return ["there are columns of Nanite, whose triangles RHI/PrimitivesDrawn does not count"]


def _recognises(head: LogHead) -> bool:
    return head.header[:1] == (_EVENTS,) or set(_THREADS) <= set(head.header)


FORMAT = LogFormat("Unreal's CSV profiler", _recognises, read_unreal_csv)
