"""The native CSV: ``time_s,x_m,y_m,z_m,qx,qy,qz,qw,cut``, in the conventions of `camera`.

Columns may stand in any order and ``cut`` (0 or 1) may be left out. A first line
``# lodbench.trace/1 {...}`` carries name, origin, repairs and field of view as JSON; a file by hand
needs none. Numbers are written so that reading gives back every bit.
"""

import csv
from pathlib import Path

import numpy as np

from ....base.arrays import refuse_rows
from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..native_columns import (
    COLUMNS,
    SCHEMA,
    Header,
    check_columns,
    columns_of,
    decode_header,
    encode_header,
    trace_of,
)
from ..text_lines import data_lines, first_data, read_lines, read_rows
from ..trace_format import TraceFormat, refuse_selector

MARK = f"# {SCHEMA} "


def read_csv(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a native CSV file.

    Raises `InputError` if the header or a row is not as this module says, or as
    `trace_from_samples`.
    """
    refuse_selector(selector, path, "native CSV")
    first = read_lines(path)[0]
    header = _header(first, path)
    numbered = data_lines(path)
    line, text = next(numbered, (1, ""))
    columns = [name.strip() for name in text.split(",")]
    check_columns(columns, path, line)
    lines, table = read_rows(numbered, columns, path, ",")
    known = dict(zip(columns, table.T, strict=True))
    cut = known.get("cut", np.zeros(len(lines)))
    refuse_rows(
        (cut != 0.0) & (cut != 1.0),
        lambda row: f"expected cut to be 0 or 1, got {cut[row]:g}; correct the row",
        path=path,
        lines=lines,
    )
    return trace_of(known, header, path, lines)


def _header(first: str, path: Path) -> Header:
    """Record in the first line, or the header of a file written by hand."""
    if first.startswith(MARK):
        return decode_header(first[len(MARK) :], path, 1)
    family, version = SCHEMA.split("/")
    if first.startswith(f"# {family}/"):
        message = (
            f"expected version {version} of {family}, got {first[2:60]!r}; "
            "write the trace with this version of lodbench"
        )
        raise InputError(message, path=path, line=1)
    return Header(path.stem)


def write_csv(trace: CameraTrace, path: Path) -> None:
    """Write a trace as native CSV."""
    *numbers, cut = columns_of(trace).values()
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"{MARK}{encode_header(trace).decode()}\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(COLUMNS)
        rows.writerows(zip(*(column.tolist() for column in numbers), cut.astype(int), strict=True))


def _recognises(head: list[str]) -> bool:
    columns = first_data(head).replace(" ", "").split(",")
    return "".join(head[:1]).startswith(MARK) or "time_s" in columns


FORMAT = TraceFormat(
    "native CSV: " + ",".join(COLUMNS), _recognises, read_csv, write_csv, (".csv",)
)
