"""Render logs as Parquet: the columns of the CSV, found by the same names.

The schema's metadata ``lodbench.header`` may hold the comment line of the CSV.
"""

from pathlib import Path
from typing import Any

import numpy as np

from ....base.errors import InputError
from ..log_build import build_log
from ..log_columns import find_columns
from ..log_format import Columns, LogFormat
from ..render_log import RenderLog
from .log_csv import header_pairs

_MAGIC = b"PAR1"
HEADER_KEY = b"lodbench.header"


def read_parquet_log(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log in a Parquet file; mapped columns go before those known by an alias.

    Raises `InputError` if the file is damaged, no column holds a time, or one is not of numbers.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        # Opened without its path: Arrow would take folders and remote addresses for data sets.
        with path.open("rb") as file:
            source: Any = parquet.ParquetFile(file)
            names: list[str] = list(source.schema_arrow.names)
            columns, notes = find_columns(names, mapping, path=path, line=None)
            table: Any = source.read(columns=[column.source for column in columns])
        values = [
            np.asarray(table.column(column.source).cast(pa.float64()).to_numpy())
            for column in columns
        ]
    except (OSError, pa.ArrowException) as error:
        what = str(error).partition("\n")[0][:120]
        message = f"expected a Parquet file of numbers, got: {what}; write it again"
        raise InputError(message, path=path) from error
    if table.num_rows == 0:
        raise InputError("expected at least one frame, got none", path=path)
    metadata: dict[bytes, bytes] = source.schema_arrow.metadata or {}
    comment = metadata.get(HEADER_KEY, b"").decode("utf-8", "replace")
    return build_log(
        np.column_stack(values),
        columns,
        name=path.stem,
        log_format="parquet",
        header=header_pairs([comment]),
        notes=notes,
    )


FORMAT = LogFormat(
    "the columns of the CSV as Parquet",
    lambda head: head.data.startswith(_MAGIC),
    read_parquet_log,
)
