"""Parquet files of columns of numbers, with texts beside them: written, and read strictly."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

_ADVICE = "write it again"

MOST_CELLS = 50_000_000
MOST_ROWS = 4_000_000
MOST_BYTES = 1 << 29
"""What a file may hold once decoded, all columns together: some 0.4 GB.

A file of a few hundred kB can say that it holds a thousand times as much.
"""


def write_columns(
    path: Path, columns: Mapping[str, NDArray[Any]], texts: Mapping[str, str | bytes]
) -> None:
    """Write columns of equal length, and texts as the metadata of the schema."""
    import pyarrow as pa
    from pyarrow import parquet

    metadata: Any = dict(texts)
    parquet.write_table(pa.table(dict(columns), metadata=metadata), path, compression="zstd")


class ParquetColumns:
    """A Parquet file, of which columns are read one by one.

    Raises `InputError` if it cannot be read.

    Attributes
    ----------
    names : of the columns, in the order of the file
    """

    def __init__(self, path: Path, advice: str = _ADVICE) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        self._path, self._advice = path, advice
        self._refusals = (pa.ArrowException, OSError, ValueError)
        try:
            # Read without its path: Arrow would take folders and remote addresses for data sets.
            self._file: Any = parquet.ParquetFile(pa.BufferReader(path.read_bytes()))
        except self._refusals as error:
            raise self._unreadable(error) from error
        self.names: list[str] = list(self._file.schema_arrow.names)
        self._require_room()

    def __len__(self) -> int:
        return self._file.metadata.num_rows

    @property
    def numeric_names(self) -> list[str]:
        """Names of the columns that hold numbers."""
        import pyarrow as pa

        def is_number(kind: Any) -> bool:
            return pa.types.is_integer(kind) or pa.types.is_floating(kind)

        return [field.name for field in self._file.schema_arrow if is_number(field.type)]

    def _require_room(self) -> None:
        """Raise InputError, before anything is decoded, if the columns would take too much."""
        known, rows = self._file.metadata, len(self)
        decoded = sum(known.row_group(i).total_byte_size for i in range(known.num_row_groups))
        if rows > MOST_ROWS or rows * len(self.names) > MOST_CELLS or decoded > MOST_BYTES:
            most = f"at most {MOST_ROWS:,} rows and {MOST_CELLS:,} values"
            got = f"{rows:,} rows of {len(self.names)} columns, {decoded:,} bytes"
            raise InputError(f"expected {most}, got {got}; split the file", path=self._path)

    def text(self, key: str) -> str:
        """Return a text of the schema's metadata, '' if there is none."""
        texts: dict[bytes, bytes] = self._file.schema_arrow.metadata or {}
        return texts.get(key.encode(), b"").decode("utf-8", "replace")

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return a column of numbers, (n,), NaN where there is none.

        Raises `InputError` if it holds something else or is damaged.
        """
        import pyarrow as pa

        return self._read(name, pa.float64()).to_numpy()

    def whole_numbers(self, name: str) -> NDArray[np.int64]:
        """Return a column of integers, (n,); raises as `numbers`, and where there is none."""
        import pyarrow as pa

        column = self._read(name, pa.int64())
        if column.null_count:
            message = f"expected a whole number in each row of {name}, got none in some"
            raise InputError(f"{message}; {self._advice}", path=self._path)
        return column.to_numpy()

    def lists(self, name: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the lists of integers of the first rows, up to the first that has none.

        They are where each begins among all, (n + 1,), and all of them.  Raises as `whole_numbers`.
        """
        import pyarrow as pa

        column = self._read(name, pa.list_(pa.int64())).combine_chunks()
        missing = np.flatnonzero(column.is_null().to_numpy(zero_copy_only=False))
        column = column[: int(missing[0]) if len(missing) else len(column)]
        values = column.flatten()
        if values.null_count:
            message = f"expected whole numbers in the lists of {name}, got none in some"
            raise InputError(f"{message}; {self._advice}", path=self._path)
        lengths = column.value_lengths().to_numpy(zero_copy_only=False)
        return np.concatenate(([0], np.cumsum(lengths, dtype=np.int64))), values.to_numpy()

    def _read(self, name: str, kind: Any) -> Any:
        try:
            # Threads save nothing here, and at the end of the process Arrow's may still run.
            column: Any = self._file.read(columns=[name], use_threads=False).column(name)
        except (*self._refusals, KeyError) as error:
            raise self._unreadable(error) from error
        try:
            return column.cast(kind)
        except self._refusals as error:
            message = f"expected numbers in column {name}, got {column.type}; write it as {kind}"
            raise InputError(message, path=self._path) from error

    def _unreadable(self, error: Exception) -> InputError:
        known = getattr(error, "strerror", None) or str(error).partition("\n")[0][:120]
        reason = known or type(error).__name__
        message = f"expected a Parquet file that can be read, got {reason}; {self._advice}"
        return InputError(message, path=self._path)
