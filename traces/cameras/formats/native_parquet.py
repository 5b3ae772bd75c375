"""The native Parquet: the columns of the native CSV, float64 and bool, and its JSON record.

The schema's metadata holds ``lodbench.schema`` = ``lodbench.trace/1`` and ``lodbench.trace``, the
JSON of name, origin, repairs and field of view.
"""

from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray, refuse_rows
from ....base.errors import InputError
from ....base.files.parquet_file import ParquetColumns, write_columns
from ..camera_trace import CameraTrace
from ..native_columns import (
    SCHEMA,
    Header,
    check_columns,
    columns_of,
    decode_header,
    encode_header,
    trace_of,
)
from ..trace_format import TraceFormat, refuse_selector

MOST_POSES = 1_000_000
"""Two hours at 120 a second.  A pose takes some kB, and a file of 100 kB can hold millions."""

SCHEMA_KEY, HEADER_KEY = "lodbench.schema", "lodbench.trace"


def read_parquet(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a native Parquet file.

    Raises `InputError` if the file is damaged, holds other columns or another schema, or as
    `trace_from_samples`; the line of an error is the 1-based row.
    """
    refuse_selector(selector, path, "native Parquet")
    table = ParquetColumns(path)
    if len(table) > MOST_POSES:
        message = f"expected at most {MOST_POSES:,} poses, got {len(table):,}"
        raise InputError(f"{message}; split the trace, or keep fewer a second", path=path)
    schema = table.text(SCHEMA_KEY)
    if schema != SCHEMA:
        message = (
            f"expected the schema {SCHEMA}, got {schema or 'none'}; "
            "write the trace with this version of lodbench"
        )
        raise InputError(message, path=path)
    text = table.text(HEADER_KEY)
    header = decode_header(text, path, None) if text else Header(path.stem)
    check_columns(table.names, path, None)
    columns = {name: _finite_column(table, name, path) for name in table.names}
    return trace_of(columns, header, path, range(1, len(table) + 1))


def _finite_column(table: ParquetColumns, name: str, path: Path) -> FloatArray:
    values = table.numbers(name)
    refuse_rows(
        ~np.isfinite(values),
        lambda row: (
            f"expected a finite number for {name}, got {values[row]}; correct or remove the row"
        ),
        path=path,
        lines=range(1, len(values) + 1),
    )
    return values


def write_parquet(trace: CameraTrace, path: Path) -> None:
    """Write a trace as native Parquet."""
    texts = {SCHEMA_KEY: SCHEMA, HEADER_KEY: encode_header(trace)}
    write_columns(path, columns_of(trace), texts)


def _recognises(head: list[str]) -> bool:
    return bool(head) and head[0].startswith("PAR1")


FORMAT = TraceFormat("native Parquet", _recognises, read_parquet, write_parquet, (".parquet",))
