"""The file of all runs of a comparison, a row each: ``runs.parquet``."""

from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from ....base.errors import InputError
from ....base.files.whole_file import write_whole
from .parts import encode_rows


def write_runs(path: Path, rows: pa.Table) -> None:
    """Write rows as `record.encode` makes them; raises `InputError` as `write_whole`."""
    write_whole(path, encode_rows(rows))


def read_runs(path: Path) -> pa.Table:
    """Return the rows of a file that `write_runs` wrote.

    Raises `InputError` if it is missing or damaged.
    """
    try:
        reader: Any = pa.BufferReader(path.read_bytes())
        # Threads save little here, and at the end of the process Arrow's may still run.
        return parquet.read_table(reader, use_threads=False)
    except (OSError, pa.ArrowException) as error:
        message = f"expected the runs of a comparison, got {error}; run `lodbench compare` again"
        raise InputError(message, path=path) from error
