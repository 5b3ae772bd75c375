"""Write a render log as `log_csv` and `log_parquet` read it: columns, and a line about them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.files.parquet_file import write_columns
from ...base.files.whole_file import whole_file, whole_text_file
from ...base.files.writable import require_file_writable
from .formats.log_parquet import HEADER_KEY

_SUFFIXES = (".parquet", ".csv")


def check_log_path(path: Path, suffixes: Sequence[str] = _SUFFIXES) -> None:
    """Raise InputError unless the path is one that `write_log`, or who writes these, can write."""
    if path.suffix not in suffixes or path.is_dir() or not path.absolute().parent.is_dir():
        message = (
            f"expected a {' or '.join(suffixes)} file in a folder that exists; name such a path"
        )
        raise InputError(message, path=path)
    require_file_writable(path)


def header_text(value: str) -> str:
    """Return a value as the header has it: one line, without the mark between values."""
    return " ".join(value.replace(";", ",").split())


def write_log(path: Path, columns: Mapping[str, NDArray[Any]], header: Mapping[str, str]) -> None:
    """Write columns of equal length, by the suffix as Parquet or CSV.

    Raises `InputError` if the path has another suffix, or cannot be written to.

    Parameters
    ----------
    header
        What the columns are of, by name; semicolons in values become commas.
    """
    check_log_path(path)
    comment = "; ".join(f"{name}: {header_text(value)}" for name, value in header.items())
    if path.suffix == ".parquet":
        with whole_file(path) as partial:
            write_columns(partial, columns, {HEADER_KEY: comment})
        return
    with whole_text_file(path) as file:
        file.write(f"# {comment}\n{','.join(columns)}\n")
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            file.write(",".join(f"{value:.10g}" for value in row) + "\n")
