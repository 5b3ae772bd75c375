"""The clock of a PresentMon file: a dozen columns, by dialect and flag, in five units.

``Time…`` is the start of Present(), ``CPUStart…`` the end of the one before.  Ticks of the
performance counter are turned into time by the frame times beside them, since no file says their
frequency; dates count from the first row.
"""

import re
from collections.abc import Mapping, Sequence
from datetime import date

import numpy as np

from ...base.arrays import FloatArray, refuse_rows
from ...base.errors import InputError
from .log_table import LogTable

# Seconds in a unit; None for ticks of the performance counter.
PRESENT_CLOCKS: dict[str, float | None] = {
    "timeinseconds": 1.0,
    "timeinms": 1e-3,
    "timeinqpc": None,
    "timeindatetime": 1.0,
}
CPU_CLOCKS: dict[str, float | None] = {
    "cpustarttime": 1e-3,
    "cpustarttimeinseconds": 1.0,
    "cpustarttimeinms": 1e-3,
    "cpustartqpc": None,
    "cpustartqpctime": 1e-3,
    "cpustartqpctimeinms": 1e-3,
    "cpustartdatetime": 1.0,
}
_DATE = re.compile(r"(\d+)-(\d+)-(\d+)[ T](\d+):(\d+):(\d+)(?:\.(\d{1,9}))?Z?")


def present_clock(
    table: LogTable, known: Mapping[str, FloatArray], rows: list[int], lines: Sequence[int]
) -> FloatArray:
    """Return the start of Present() of the chosen rows in seconds.

    A row without a time has NaN.

    Raises `InputError` if there is no clock, no row has a time, or times decrease.
    """
    names = [name.lower() for name in table.header]
    clocks = {**PRESENT_CLOCKS, **CPU_CLOCKS}
    name = next((name for name in clocks if name in names), None)
    if name is None:
        message = (
            f"expected a column with the time ({', '.join(clocks)}), got none; capture with one"
        )
        raise InputError(message, path=table.path, line=table.first_line - 1)
    at_present = name in PRESENT_CLOCKS
    clock = _read(table, names.index(name), rows)
    unit_s = clocks[name]
    if unit_s is None:
        interval_ms = _intervals(known, len(rows), at_present=at_present)
        first = clock[np.isfinite(clock)][:1]
        time_s = (clock - first) * _tick_s(clock, interval_ms, table) if len(first) else clock
    else:
        time_s = clock * unit_s
    if not at_present:
        busy_ms = known.get("cpu_busy_ms", np.zeros(len(rows)))
        time_s = time_s + np.nan_to_num(busy_ms) / 1e3
    _require_order(time_s, table, lines)
    return time_s


def _intervals(known: Mapping[str, FloatArray], rows: int, *, at_present: bool) -> FloatArray:
    """Return the milliseconds that should lie between each row and the one before it."""
    nothing = np.full(rows, np.nan)
    if at_present:
        return known.get("between_presents_ms", nothing)
    return np.concatenate([[np.nan], known.get("frame_ms", nothing)[:-1]])


def _tick_s(clock: FloatArray, interval_ms: FloatArray, table: LogTable) -> float:
    ratios = interval_ms[1:] / np.where(np.diff(clock) > 0.0, np.diff(clock), np.nan)
    ratios = ratios[ratios > 0.0]
    if len(clock) == 1:
        return 0.0  # one row, at 0
    if ratios.size == 0:
        message = "expected frame times beside the ticks of the clock, got none; use --date_time"
        raise InputError(message, path=table.path)
    return float(np.median(ratios)) / 1e3


def _read(table: LogTable, column: int, rows: list[int]) -> FloatArray:
    texts = table.texts(column)
    if not any(_DATE.fullmatch(texts[row].strip()) for row in rows[:10]):
        return table.numbers([column])[rows, 0]
    times_ns = [_date_ns(texts[row].strip()) for row in rows]
    first_ns = next((ns for ns in times_ns if ns is not None), 0)
    return np.array([np.nan if ns is None else (ns - first_ns) / 1e9 for ns in times_ns])


def _date_ns(text: str) -> int | None:
    """Return the nanoseconds of a date such as 2026-9-18 8:57:43.386354900, None if it is none."""
    match = _DATE.fullmatch(text)
    if match is None:
        return None
    year, month, day, hour, minute, second = (int(group) for group in match.groups()[:6])
    try:
        days = date(year, month, day).toordinal()
    except ValueError:
        return None
    seconds = ((days * 24 + hour) * 60 + minute) * 60 + second
    return seconds * 1_000_000_000 + int((match[7] or "0").ljust(9, "0"))


def _require_order(time_s: FloatArray, table: LogTable, lines: Sequence[int]) -> None:
    timed = np.flatnonzero(np.isfinite(time_s))
    if not len(timed):
        message = "expected a time in each row, got none; capture again"
        raise InputError(message, path=table.path, line=table.first_line)
    time_s, lines = time_s[timed], [lines[int(row)] for row in timed.tolist()]
    refuse_rows(
        np.append(False, np.diff(time_s) < 0.0),
        lambda row: (
            f"expected times that never decrease, got {time_s[row]:.9g} s after "
            f"{time_s[row - 1]:.9g} s; sort the rows of each swap chain by time"
        ),
        path=table.path,
        lines=lines,
    )
