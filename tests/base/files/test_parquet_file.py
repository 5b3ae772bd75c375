"""Parquet files of numbers: what comes back, and what is refused in one line."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from lodbench.base.errors import InputError
from lodbench.base.files.parquet_file import ParquetColumns, write_columns


def test_columns_and_texts_come_back(tmp_path: Path) -> None:
    """Names, numbers to the last bit, missing ones as NaN, and texts are those written."""
    path = tmp_path / "a.parquet"
    write_columns(path, {"x": np.array([0.1, np.nan]), "n": np.array([1, 2**60])}, {"who": "me"})
    table = ParquetColumns(path)
    assert (table.names, len(table), table.text("who"), table.text("no")) == (
        ["x", "n"],
        2,
        "me",
        "",
    )
    assert np.array_equal(table.numbers("x"), [0.1, np.nan], equal_nan=True)
    assert table.whole_numbers("n").tolist() == [1, 2**60]


@pytest.mark.parametrize("values", [["x"], [b"\xff"], [{"a": 1}], [[1.0]]])
def test_other_types_are_refused(tmp_path: Path, values: list[Any]) -> None:
    """Texts, bytes, records and lists are no numbers, and the column is named."""
    parquet.write_table(pa.table({"x": values}), tmp_path / "a.parquet")
    table = ParquetColumns(tmp_path / "a.parquet")
    for read in (table.numbers, table.whole_numbers):
        with pytest.raises(InputError, match=r"expected numbers in column x, got .*; write it as"):
            read("x")


@pytest.mark.parametrize("values", [[1.0, None], [1.5, 2.0], [np.nan, 1.0], [2.0**70]])
def test_what_is_no_whole_number_is_refused(tmp_path: Path, values: list[Any]) -> None:
    """Gaps, fractions, NaN and what 64 bits do not hold would be other times than were meant."""
    parquet.write_table(pa.table({"x": values}), tmp_path / "a.parquet")
    with pytest.raises(InputError, match="expected"):
        ParquetColumns(tmp_path / "a.parquet").whole_numbers("x")


def test_damaged_pages_are_refused(tmp_path: Path) -> None:
    """A file whose footer is whole and whose pages are not is found out when a column is read."""
    path = tmp_path / "a.parquet"
    write_columns(path, {"x": np.arange(1000.0)}, {})
    data = bytearray(path.read_bytes())
    data[4:60] = bytes(56)
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"a\.parquet: expected a Parquet file that can be read"):
        ParquetColumns(path).numbers("x")
