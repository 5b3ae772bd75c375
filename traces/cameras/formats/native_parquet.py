"""The native Parquet: the columns of the native CSV, float64 and bool, and its JSON record.

The schema's metadata holds ``lodbench.schema`` = ``lodbench.trace/1`` and ``lodbench.trace``, the
JSON of name, origin and repairs.
"""

from pathlib import Path
from typing import Any

import numpy as np

from ....base.errors import InputError
from ..camera_trace import CameraTrace, FloatArray
from ..native_columns import REQUIRED, SCHEMA, Header, check_columns, decode_header, encode_header
from ..samples import trace_from_samples
from ..trace_format import TraceFormat, refuse_selector

SCHEMA_KEY = b"lodbench.schema"
HEADER_KEY = b"lodbench.trace"


def read_parquet(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a native Parquet file.

    Raises `InputError` if the file is damaged, holds other columns or another schema, or as
    `trace_from_samples`; the line of an error is the 1-based row.
    """
    refuse_selector(selector, path, "native Parquet")
    table = _read_table(path)
    metadata: dict[bytes, bytes] = table.schema.metadata or {}
    schema = metadata.get(SCHEMA_KEY, b"").decode("utf-8", "replace")
    if schema != SCHEMA:
        raise InputError(
            f"expected the schema {SCHEMA}, got {schema or 'none'}; "
            "write the trace with this version of lodbench",
            path=path,
        )
    header = (
        decode_header(metadata[HEADER_KEY], path, None)
        if HEADER_KEY in metadata
        else Header(path.stem)
    )
    check_columns(table.column_names, path, None)
    columns = np.column_stack([_finite_column(table, name, path) for name in REQUIRED])
    cut = _finite_column(table, "cut", path) if "cut" in table.column_names else None
    return trace_from_samples(
        header.name,
        path,
        range(1, len(columns) + 1),
        time_s=columns[:, 0],
        position_m=columns[:, 1:4],
        orientation_xyzw=columns[:, 4:8],
        cut=None if cut is None else cut != 0.0,
        origin_s=header.origin_s,
        repairs=header.made_repairs(),
    )


def _read_table(path: Path) -> Any:
    import pyarrow as pa
    from pyarrow import parquet

    refusals: tuple[type[Exception], ...] = (pa.ArrowException, OSError, ValueError)
    try:
        with path.open("rb") as file:
            table: Any = parquet.read_table(file)
    except refusals as error:
        reason = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise InputError(
            f"expected a Parquet file that can be read, got {reason}; write it again", path=path
        ) from error
    return table


def _finite_column(table: Any, name: str, path: Path) -> FloatArray:
    import pyarrow as pa

    refusals: tuple[type[Exception], ...] = (pa.ArrowException, ValueError)
    try:
        values: FloatArray = table.column(name).cast(pa.float64()).to_numpy()
    except refusals as error:
        raise InputError(
            f"expected numbers in column {name}, got {table.schema.field(name).type}; "
            "write it as float64",
            path=path,
        ) from error
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        raise InputError(
            f"expected a finite number for {name}, got {values[wrong[0]]}; "
            "correct or remove the row",
            path=path,
            line=int(wrong[0]) + 1,
        )
    return values


def write_parquet(trace: CameraTrace, path: Path) -> None:
    """Write a trace as native Parquet."""
    import pyarrow as pa
    from pyarrow import parquet

    numbers = np.column_stack([trace.time_s, trace.position_m, trace.orientation_xyzw])
    arrays: dict[str, Any] = dict(zip(REQUIRED, numbers.T.copy(), strict=True))
    table: Any = pa.table({**arrays, "cut": trace.cut})
    metadata = {SCHEMA_KEY: SCHEMA.encode(), HEADER_KEY: encode_header(trace)}
    described: Any = table.replace_schema_metadata(metadata)
    parquet.write_table(described, path)


def _recognises(head: list[str]) -> bool:
    return bool(head) and head[0].startswith("PAR1")


FORMAT = TraceFormat("native Parquet", _recognises, read_parquet, write_parquet, (".parquet",))
