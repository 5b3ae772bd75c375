"""In which unit the times of a log are: by name, by size, and against an independent clock.

A median frame lies between 0.02 and 1,000 ms.  Units are a thousand apart, so of a size at most two
are possible, of which one is usual: from 0.2 to 200 ms exactly one unit fits.  Where the other is
possible too, frame times that add up to the clock's time decide, or busy times that a frame has
room for.  Where nothing decides, the user is asked.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..log_columns import MS_PER, LogColumn
from ..render_log import TIMES

_LEAST_MS, _MOST_MS = 0.02, 1e3  # of a median frame
_USUAL_MS = (0.2, 200.0)  # exactly one unit lies in it
_OPEN_MS = 0.8  # below, the next larger unit gives a frame of under a second: possible too
_NAMED_MS = (0.002, 1e4)  # what a name's own unit is believed within
_AGREES = 3.0  # factor within which frame times add up to a clock's time
_ROOM = 3.0  # frames that a busy time may fill
_LITTLE = 2e3  # part of a frame, below which a busy time is none
_ALIKE = 0.01  # part of a frame, from which a busy time is in the frame's unit for sure
_NAMES = {"ns": "nanoseconds", "us": "microseconds", "ms": "milliseconds", "s": "seconds"}


@dataclass(frozen=True, slots=True)
class Settled:
    """Columns of times with a unit each, and how it was found, by their place."""

    columns: tuple[LogColumn, ...]
    why: dict[int, str]


def settle_units(
    columns: Sequence[LogColumn],
    values: FloatArray,
    refuse: Callable[[str], InputError],
) -> Settled:
    """Return the columns, each time with a unit.

    Parameters
    ----------
    values
        (n, len(columns)), in the units of the file; NaN is missing.
    refuse
        Makes the error about a message.

    Raises `InputError` if a unit cannot be told, with the mapping that says it.
    """
    settled, why = list(columns), dict[int, str]()
    clock_ms = _clock_interval_ms(columns, values)
    frame: tuple[float, str] | None = None  # median in ms, unit of the file
    for place in sorted(range(len(columns)), key=lambda i: columns[i].name != "frame_ms"):
        column = columns[place]
        if column.name not in TIMES or column.unit == "fps":
            continue
        median = _median(values[:, place])
        if median is None:
            unit, reason = column.unit or "ms", ""
        elif column.unit:
            unit, reason = column.unit, ""
            if not column.stated:
                _require_possible(column, median, clock_ms, refuse)
        elif column.name == "frame_ms":
            unit, reason = _frame_unit(column, median, clock_ms, refuse)
        else:
            unit, reason = _busy_unit(column, median, frame, clock_ms, refuse)
        settled[place], why[place] = replace(column, unit=unit), reason
        if column.name == "frame_ms" and median is not None:
            frame = (median * MS_PER[unit], unit)
    return Settled(tuple(settled), why)


def clock_unit(column: LogColumn, values: FloatArray, refuse: Callable[[str], InputError]) -> str:
    """Return the unit of a clock without frame times beside it, by the size of its steps.

    Raises `InputError` if they may be of two.
    """
    step = _median(np.diff(values[np.isfinite(values)]))
    return "s" if step is None else _frame_unit(column, step, None, refuse)[0]


def _median(values: FloatArray) -> float | None:
    good = values[np.isfinite(values) & (values > 0.0)]
    return float(np.median(good)) if len(good) else None


def _clock_interval_ms(columns: Sequence[LogColumn], values: FloatArray) -> float | None:
    """Return the mean step of the clock, if the unit of it is known."""
    place = next((i for i, c in enumerate(columns) if c.name == "time_s" and c.unit), None)
    if place is None:
        return None
    clock = values[:, place]
    clock = clock[np.isfinite(clock)]
    if len(clock) < 2:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(clock)
        forward = steps[steps > 0.0]
        total = float(forward.sum()) * MS_PER[columns[place].unit]
    return total / len(forward) if len(forward) and np.isfinite(total) and total > 0.0 else None


def _require_possible(
    column: LogColumn,
    median: float,
    clock_ms: float | None,
    refuse: Callable[[str], InputError],
) -> None:
    least = _LEAST_MS if column.name == "frame_ms" else _NAMED_MS[0]
    size_ms = median * MS_PER[column.unit]
    if least <= size_ms <= _NAMED_MS[1] or (
        clock_ms is not None and _near(size_ms, clock_ms, _AGREES)
    ):
        return
    raise _ask(column, median, [column.unit, *_possible(median)], refuse)


def _frame_unit(
    column: LogColumn,
    median: float,
    clock_ms: float | None,
    refuse: Callable[[str], InputError],
) -> tuple[str, str]:
    possible = _possible(median)
    if clock_ms is not None:
        for unit in possible:
            if _near(median * MS_PER[unit], clock_ms, _AGREES):
                return unit, f"{_NAMES[unit]}, since they add up to the clock's time"
    usual = _usual(median)
    if usual is None or (median * MS_PER[usual] < _OPEN_MS and len(possible) > 1):
        raise _ask(column, median, possible, refuse)
    return usual, _by_size(median, usual)


def _busy_unit(
    column: LogColumn,
    median: float,
    frame: tuple[float, str] | None,
    clock_ms: float | None,
    refuse: Callable[[str], InputError],
) -> tuple[str, str]:
    interval_ms = frame[0] if frame is not None else clock_ms
    possible = _possible(median)
    if interval_ms is not None:
        room = [
            unit
            for unit in MS_PER
            if interval_ms / _LITTLE <= median * MS_PER[unit] <= _ROOM * interval_ms
        ]
        alike = frame is not None and median * MS_PER[frame[1]] >= _ALIKE * interval_ms
        if frame is not None and alike and frame[1] in room:
            return frame[1], f"{_NAMES[frame[1]]}, as the frame times"
        if len(room) == 1:
            return room[0], f"{_NAMES[room[0]]}, since no other fits into a frame"
        if len(room) > 1:
            raise _ask(column, median, room, refuse)
        possible = [unit for unit in possible if unit in room] or possible
    usual = _usual(median)
    small = median * MS_PER["ms"] < _USUAL_MS[0] and "ms" in possible  # a fast GPU, or seconds
    low = usual is not None and median * MS_PER[usual] < _OPEN_MS
    if usual not in possible or ((small or low) and len(possible) > 1):
        raise _ask(column, median, possible, refuse)
    return usual, _by_size(median, usual)


def _possible(median: float) -> list[str]:
    return [unit for unit in MS_PER if _LEAST_MS <= median * MS_PER[unit] <= _MOST_MS]


def _usual(median: float) -> str | None:
    low, high = _USUAL_MS
    return next((unit for unit in MS_PER if low <= median * MS_PER[unit] < high), None)


def _near(one: float, other: float, factor: float) -> bool:
    return other / factor <= one <= other * factor


def _by_size(median: float, unit: str) -> str:
    return f"{_NAMES[unit]}, by their size: the median is {median * MS_PER[unit]:.3g} ms"


def _ask(
    column: LogColumn,
    median: float,
    possible: Sequence[str],
    refuse: Callable[[str], InputError],
) -> InputError:
    units = list(dict.fromkeys(possible)) or list(MS_PER)
    sizes = " or ".join(f"{median * MS_PER[unit]:.3g} ms as {unit}" for unit in units[:3])
    asked = " or ".join(f"--map {column.name}={column.source}:{unit}" for unit in units[:3])
    return refuse(
        f"expected the unit of {column.source} to be clear, got a median of {median:.3g}: "
        f"{sizes}; say which by {asked}"
    )
