"""A render log from the columns that were found in a file."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import log
from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError, printable
from .columns.column_roles import smell_of
from .columns.column_units import clock_unit, settle_units
from .log_columns import MS_PER, TIMED, FoundColumns, LogColumn, no_time
from .render_log import RECORDED, TIMES, ColumnSource, RenderLog

STEPS = "the steps of"
"""How the source of frame times begins that are those of a clock, where the file has no others."""

_ASIDE = (*TIMED, *RECORDED)  # what counts nothing
# Columns of `lodbench record` that no fit takes for a time or a count: nobody has to map them.
_KNOWN = {
    "trace_s",
    "prepare_ms",
    "policy_ms",
    "vertex_shader_invocations",
    "clipping_input_primitives",
    "clipping_output_primitives",
}
_BACKWARDS = 0.05  # share of steps back, above which a column is no clock


@dataclass(frozen=True, slots=True)
class LogText:
    """What is said of a log beside its numbers.

    Attributes
    ----------
    header : pairs of key and value
    notes : what the reader assumed or left aside
    odd : cells and rows that were no measurements, to be warned of
    unused : columns of numbers that serve nothing
    """

    header: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    odd: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()


def build_log(
    values: FloatArray,
    found: FoundColumns,
    text: LogText,
    *,
    path: Path,
    log_format: str,
    unit: str = "",
) -> RenderLog:
    """Return the log that columns of a file hold, its times in milliseconds.

    Where the header states a resolution, ``framebuffer_pixels`` is a predictor.

    Where the file has a clock and no time, frame times are its steps.

    Raises `InputError` if the unit of a time cannot be told, or the only time is no clock.

    Parameters
    ----------
    values
        (n, len(found.columns)), in the units of the file.
    unit
        Of times whose name states none, where the tool is known; '' finds it out.
    """
    columns = found.columns
    if unit:
        columns = tuple(replace(c, unit=c.unit or unit) if c.name in TIMES else c for c in columns)
        why: dict[int, str] = {}
    else:
        settled = settle_units(columns, values, _refusal(path))
        columns, why = settled.columns, settled.why
    times, sources = _times(columns, values, why)
    clock, clock_source, clock_note = _clock(columns, values, times, _refusal(path))
    if not times:
        if clock is None:
            raise no_time([c.source for c in columns], path, None)
        times["frame_ms"] = np.diff(clock, prepend=np.nan) * 1e3
        sources.append(ColumnSource("frame_ms", f"{STEPS} {clock_source[0].source}", "ms"))
    counts = {
        c.name: values[:, i] * c.multiplier for i, c in enumerate(columns) if c.name not in _ASIDE
    }
    sources += clock_source
    sources += [
        ColumnSource(c.name, c.source, "count" if c.multiplier == 1.0 else f"{c.multiplier:g}")
        for c in columns
        if c.name not in _ASIDE
    ]
    pixels = _pixels(text.header)
    if pixels:
        counts.setdefault("framebuffer_pixels", np.full(len(values), pixels))
    said = [str(source) for source in sources if source.name in TIMED]
    scaled = [f"{s.name} is {s.source} times {s.unit}" for s in sources if s.unit[:1].isdigit()]
    return RenderLog(
        name=path.stem,
        format=log_format,
        predictors=tuple(counts),
        counts=np.column_stack(list(counts.values())) if counts else np.empty((len(values), 0)),
        frame_ms=times.get("frame_ms"),
        gpu_ms=times.get("gpu_ms"),
        cpu_ms=times.get("cpu_ms"),
        time_s=clock,
        header=text.header,
        # Names of columns are the file's, and may hold what moves a terminal's cursor.
        notes=tuple(
            map(printable, (*text.notes, *found.notes, *said, *scaled, *_listed(text.unused)))
        ),
        warnings=tuple(map(printable, (*text.odd, *clock_note, *_smells(text.unused, times)))),
        sources=tuple(sources),
        unused=text.unused,
        recorded={c.name: values[:, i] for i, c in enumerate(columns) if c.name in RECORDED},
    )


def _refusal(path: Path) -> Callable[[str], InputError]:
    return lambda message: InputError(message, path=path)


def _times(
    columns: Sequence[LogColumn], values: FloatArray, why: dict[int, str]
) -> tuple[dict[str, FloatArray], list[ColumnSource]]:
    """Return times in ms by name, of several the longest, and where they come from."""
    times: dict[str, FloatArray] = {}
    sources: list[ColumnSource] = []
    for place, column in enumerate(columns):
        if column.name not in TIMES:
            continue
        if column.unit == "fps":
            with np.errstate(divide="ignore", over="ignore"):
                time_ms = 1e3 / values[:, place]
            sources.append(ColumnSource(column.name, f"1000 / {column.source}", "ms"))
        else:
            time_ms = _scaled(values[:, place], MS_PER[column.unit])
            reason = why.get(place, "")
            sources.append(ColumnSource(column.name, column.source, column.unit, reason))
        before = times.get(column.name)
        times[column.name] = time_ms if before is None else np.fmax(before, time_ms)
    return times, sources


def _clock(
    columns: Sequence[LogColumn],
    values: FloatArray,
    times: dict[str, FloatArray],
    refuse: Callable[[str], InputError],
) -> tuple[FloatArray | None, list[ColumnSource], list[str]]:
    """Return the clock in seconds; what runs backwards again and again is none, and warned of."""
    place = next((i for i, c in enumerate(columns) if c.name == "time_s"), None)
    if place is None:
        return None, [], []
    column, clock = columns[place], values[:, place]
    known = clock[np.isfinite(clock)]
    back = int((known[1:] < known[:-1]).sum())
    if not column.stated and column.source != "time_s" and back > max(3, _BACKWARDS * len(known)):
        warning = (
            f"{column.source} runs backwards {back:,} times, so it is no clock and not used; if it "
            f"is a frame's time, --map frame_ms={column.source}"
        )
        return None, [], [warning]
    if times:
        unit = column.unit or _clock_unit(clock, times.get("frame_ms"))
    else:
        unit = column.unit or clock_unit(column, clock, refuse)
    source = ColumnSource("time_s", column.source, unit)
    return _scaled(clock, MS_PER[unit] / 1e3), [source], []


def _listed(unused: Sequence[str]) -> list[str]:
    if not unused:
        return []
    shown = ", ".join(unused[:12]) + (f" and {len(unused) - 12} more" if len(unused) > 12 else "")
    return [f"not used: {shown}"]


def _smells(unused: Sequence[str], times: dict[str, FloatArray]) -> list[str]:
    """Return a warning about unused columns whose names smell of a time, and one of a count."""
    warnings: list[str] = []
    free = next((name for name in ("gpu_ms", "cpu_ms", "frame_ms") if name not in times), "gpu_ms")
    for kind, example in (("time", free), ("count", "triangles")):
        names = [name for name in unused if name not in _KNOWN and smell_of(name) == kind]
        if names:
            shown = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
            warnings.append(
                f"not used though the name smells of a {kind}: {shown}; map what is meant, such as "
                f"--map {example}={names[0]}"
            )
    return warnings


def _scaled(values: FloatArray, factor: float) -> FloatArray:
    """Return values in another unit; what overflows is infinite, and so no measurement."""
    with np.errstate(over="ignore"):
        return values * factor


def _clock_unit(clock: FloatArray, frame_ms: FloatArray | None) -> str:
    """Return the unit in which a clock runs nearest to the sum of the frame times."""
    clock = clock[np.isfinite(clock)]
    if frame_ms is None or len(clock) < 2:
        return "s"
    with np.errstate(over="ignore", invalid="ignore"):
        span = float(np.ptp(clock))
        total = float(frame_ms[np.isfinite(frame_ms)].sum())
    if not (0.0 < span < np.inf and 0.0 < total < np.inf):
        return "s"
    return min(MS_PER, key=lambda unit: abs(log(span) + log(MS_PER[unit]) - log(total)))


def _pixels(header: Sequence[tuple[str, str]]) -> float:
    for key, value in header:
        size = re.fullmatch(r"(\d{1,6})x(\d{1,6})", value)
        if key == "resolution" and size:
            return float(size[1]) * float(size[2])
    return 0.0
