"""A render log from the columns that were found in a file."""

import re
from collections.abc import Sequence
from math import log

import numpy as np

from ...base.arrays import FloatArray
from .log_columns import MS_PER, LogColumn
from .render_log import TIMES, RenderLog


def build_log(
    values: FloatArray,
    columns: Sequence[LogColumn],
    *,
    name: str,
    log_format: str,
    header: tuple[tuple[str, str], ...] = (),
    notes: Sequence[str] = (),
) -> RenderLog:
    """Return the log that columns of a file hold, its times in milliseconds.

    Where the header states a resolution, ``framebuffer_pixels`` is a predictor.

    Parameters
    ----------
    values
        (n, len(columns)), in the units of the file.
    """
    held = dict(zip(columns, values.T, strict=True))
    times = {
        column.name: _scaled(value, MS_PER[column.unit or "ms"])
        for column, value in held.items()
        if column.name in TIMES
    }
    sources = [f"{c.name} is {c.source} in {_stated(c)}" for c in columns if c.name in TIMES]
    for column, value in held.items():
        if column.name == "time_s":
            unit = column.unit or _clock_unit(value, times.get("frame_ms"))
            times["time_s"] = _scaled(value, MS_PER[unit] / 1e3)
            sources.append(f"time_s is {column.source} in {unit}")
    counts = {column.name: value for column, value in held.items() if column.name not in times}
    pixels = _pixels(header)
    if pixels:
        counts.setdefault("framebuffer_pixels", np.full(len(values), pixels))
    return RenderLog(
        name=name,
        format=log_format,
        predictors=tuple(counts),
        counts=np.column_stack(list(counts.values())) if counts else np.empty((len(values), 0)),
        frame_ms=times.get("frame_ms"),
        gpu_ms=times.get("gpu_ms"),
        cpu_ms=times.get("cpu_ms"),
        time_s=times.get("time_s"),
        header=header,
        notes=(*notes, *sources),
    )


def _stated(column: LogColumn) -> str:
    return column.unit or "ms, since its name has no unit"


def _scaled(values: FloatArray, factor: float) -> FloatArray:
    """Return values in another unit; what overflows is infinite, and so no measurement."""
    with np.errstate(over="ignore"):
        return values * factor


def _clock_unit(clock: FloatArray, frame_ms: FloatArray | None) -> str:
    """Return the unit in which a clock runs nearest to the sum of the frame times."""
    clock = clock[np.isfinite(clock)]
    if frame_ms is None or len(clock) < 2:
        return "s"
    span = float(clock[-1] - clock[0])
    with np.errstate(over="ignore", invalid="ignore"):
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
