"""Render logs as CSV with a header: lodbench's own, and any other by aliases or a mapping.

Lodbench's own has the columns ``draw_calls, vertices, triangles, shaded_samples`` … of
`renderlog.GPU_COUNTS` and ``cpu_ms, gpu_ms, frame_ms, time_s``, and a first line
``# renderer: NAME; VERSION; WIDTHxHEIGHT; mode MODE; seed SEED``.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError
from .columns import MS_PER, Column, find_columns
from .logtable import LogTable, split_table
from .renderlog import TIMES, FloatArray, RenderLog

__all__ = ["header_pairs", "log_from_columns", "read_csv_log"]


def read_csv_log(data: bytes, path: Path, mapping: Mapping[str, str] | None = None) -> RenderLog:
    """Return the log in a CSV; `data` is what `read_log_bytes` gave.

    Raises
    ------
    InputError
        If no column holds a time, or a row is broken.
    """
    table = split_table(data, path)
    columns, notes = find_columns(table, mapping)
    header = header_pairs(table.comments)
    return log_from_columns(table, columns, "csv", header=header, notes=notes)


def header_pairs(comments: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return pairs of key and value of comment lines such as ``renderer: R; 640x360; seed 3``."""
    pairs: list[tuple[str, str]] = []
    for part in (part.strip() for comment in comments for part in comment.split(";")):
        named = re.match(r"([^:=]{1,60}?)\s*[:=]\s*(.+)", part) or re.match(r"([a-z]+) (\S+)$", part)
        if named:
            pairs.append((named[1], named[2]))
        elif re.fullmatch(r"\d+x\d+", part):
            pairs.append(("resolution", part))
        elif part:
            pairs.append(("version", part))
    return tuple(pairs)


def log_from_columns(
    table: LogTable,
    columns: Sequence[Column],
    log_format: str,
    *,
    header: tuple[tuple[str, str], ...] = (),
    notes: Sequence[str] = (),
) -> RenderLog:
    """Return the log that the chosen columns of a table hold.

    Where the header states a resolution, ``framebuffer_pixels`` is a predictor.

    Raises
    ------
    InputError
        If no column holds a time, or a row is broken.
    """
    if not any(column.name in TIMES for column in columns):
        raise InputError(
            f"expected a column with a time ({', '.join(TIMES)}), got {', '.join(table.header)}"
            "; map one, such as gpu_ms=NAME",
            path=table.path,
            line=table.first_line - 1,
        )
    values = table.numbers([column.index for column in columns])
    said = list(notes)
    times: dict[str, FloatArray] = {}
    names: list[str] = []
    counts: list[FloatArray] = []
    for column, value in zip(columns, values.T, strict=True):
        if column.name in TIMES:
            unit = column.unit or "ms"
            times[column.name] = value * MS_PER[unit]
            stated = unit if column.unit else f"{unit}, since its name has no unit"
            said.append(f"{column.name} is {column.source} in {stated}")
        elif column.name != "time_s":
            names.append(column.name)
            counts.append(value)
    for column, value in zip(columns, values.T, strict=True):
        if column.name == "time_s":
            unit = column.unit or _clock_unit(value, times.get("frame_ms"))
            times["time_s"] = value * (MS_PER[unit] / 1e3)
    pixels = _pixels(header)
    if pixels and "framebuffer_pixels" not in names:
        names.append("framebuffer_pixels")
        counts.append(np.full(len(values), pixels))
    return RenderLog(
        name=table.path.stem,
        format=log_format,
        predictors=tuple(names),
        counts=np.column_stack(counts) if counts else np.empty((len(values), 0)),
        header=header,
        notes=tuple(said),
        frame_ms=times.get("frame_ms"),
        gpu_ms=times.get("gpu_ms"),
        cpu_ms=times.get("cpu_ms"),
        time_s=times.get("time_s"),
    )


def _clock_unit(clock: FloatArray, frame_ms: FloatArray | None) -> str:
    """Return the unit in which a clock runs nearest to the sum of the frame times."""
    clock = clock[np.isfinite(clock)]
    if frame_ms is None or len(clock) < 2 or clock[-1] <= clock[0]:
        return "s"
    total = float(np.nansum(frame_ms))
    span = float(clock[-1] - clock[0])
    if total <= 0.0:
        return "s"
    return min(MS_PER, key=lambda unit: abs(np.log(span * MS_PER[unit] / total)))


def _pixels(header: Sequence[tuple[str, str]]) -> float:
    for key, value in header:
        size = re.fullmatch(r"(\d+)x(\d+)", value)
        if key == "resolution" and size:
            return float(size[1]) * float(size[2])
    return 0.0
