"""CSV of Unity's profiler counters, as a script with ``ProfilerRecorder`` writes it.

There is no standard file: the columns are the counters' names (``Draw Calls Count``, ``Triangles
Count``, ``GPU Frame Time``…).  Counters of time are nanoseconds, the ``FrameTiming`` struct has
milliseconds, and scripts write either, so the unit comes from the values: no frame takes 10,000 ms
and none 10,000 ns.  ``cpu_ms`` is the longer of main and render thread.  Profile Analyzer's frame
CSV (``Frame Time (ms)`` between semicolons) is read for its times.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..log_build import build_log
from ..log_columns import LogColumn, find_columns
from ..log_format import Columns, LogFormat
from ..log_table import LogTable, read_log_bytes, split_table
from ..render_log import TIMES, RenderLog

_MARKS = frozenset(
    (
        *("CPU Total Frame Time", "CPU Main Thread Frame Time", "CPU Render Thread Frame Time"),
        *("GPU Frame Time", "SetPass Calls Count", "Draw Calls Count", "Batches Count"),
        *("Triangles Count", "Vertices Count", "Time from first frame (ms)"),
    )
)
_THREADS = ("CPU Main Thread Frame Time", "CPU Render Thread Frame Time")
_NS_ABOVE = 1e4


def read_unity_csv(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log of a CSV of counters; mapped columns go before the usual ones.

    Raises `InputError` if the file has no rows, no known time, or no number where one is expected.
    """
    table = split_table(read_log_bytes(path), path)
    found, notes = find_columns(table.header, mapping, path=path, line=table.first_line - 1)
    columns, unit = _with_unit(table, found)
    log = build_log(
        table.numbers([column.index for column in columns]),
        columns,
        name=path.stem,
        log_format="unity",
        notes=[*notes, *unit],
    )
    if any(name not in table.header for name in _THREADS) or "cpu_ms" in (mapping or {}):
        return log
    factor = 1e-6 if unit else 1.0
    threads = table.numbers([table.header.index(name) for name in _THREADS]) * factor
    note = f"cpu_ms is the longer of {' and '.join(_THREADS)}"
    return replace(log, cpu_ms=np.fmax(*threads.T), notes=(*log.notes, note))


def _with_unit(
    table: LogTable, columns: Sequence[LogColumn]
) -> tuple[tuple[LogColumn, ...], tuple[str, ...]]:
    """Put nanoseconds on times without a unit in the name if that is what the values are."""
    unnamed = [column for column in columns if column.name in TIMES and not column.unit]
    if not unnamed:
        return tuple(columns), ()
    values = table.numbers([column.index for column in unnamed])
    measured = values[np.isfinite(values) & (values > 0.0)]
    if not len(measured) or float(np.median(measured)) < _NS_ABOVE:
        return tuple(columns), ()
    changed = (replace(column, unit="ns") if column in unnamed else column for column in columns)
    note = f"times are nanoseconds, since their median is {np.median(measured):.3g}"
    return tuple(changed), (note,)


FORMAT = LogFormat(
    "Unity's profiler counters as CSV",
    lambda head: not _MARKS.isdisjoint(head.header),
    read_unity_csv,
)
