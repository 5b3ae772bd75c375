"""Render logs as Parquet: the columns of the CSV, found by the same names.

The schema's metadata ``lodbench.header`` may hold the comment line of the CSV.
"""

from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ....base.files.parquet_file import ParquetColumns
from ..log_build import LogText, build_log
from ..log_columns import find_columns
from ..log_format import Columns, LogFormat
from ..render_log import RenderLog
from .log_csv import header_pairs

HEADER_KEY = "lodbench.header"


def read_parquet_log(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log in a Parquet file; mapped columns go before those known by an alias.

    Raises `InputError` if the file is damaged, no column holds a time, or one is not of numbers.
    """
    table = ParquetColumns(path)
    found = find_columns(table.names, mapping, path=path, line=None)
    if len(table) == 0:
        raise InputError("expected at least one frame, got none", path=path)
    values = np.column_stack([table.numbers(column.source) for column in found.columns])
    numeric = set(table.numeric_names)
    unused = tuple(name for _, name in found.unused if name in numeric)
    text = LogText(header_pairs([table.text(HEADER_KEY)]), unused=unused)
    return build_log(values, found, text, path=path, log_format="parquet")


FORMAT = LogFormat(
    "the columns of the CSV as Parquet",
    lambda head: head.data.startswith(b"PAR1"),
    read_parquet_log,
)
