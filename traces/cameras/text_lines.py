"""Lines and numbers of a text file, with errors that name the file and the line."""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.files.text_file import read_text


def read_lines(path: Path) -> list[str]:
    """Lines of a text file without their ends, of whichever kind; raises as `read_text`."""
    return read_text(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")


def data_lines(path: Path) -> Iterator[tuple[int, str]]:
    """1-based number and text of each line that is neither blank nor a ``#`` comment."""
    for number, line in enumerate(read_lines(path), start=1):
        text = line.strip()
        if text and not text.startswith("#"):
            yield number, text


def first_data(head: list[str]) -> str:
    """First of some lines that is no comment, '' if there is none."""
    return next((line for line in head if not line.startswith("#")), "")


def read_rows(
    numbered: Iterable[tuple[int, str]],
    names: Sequence[str],
    path: Path,
    delimiter: str | None = None,
) -> tuple[list[int], FloatArray]:
    """Numbers of lines and rows (n, columns) of n `data_lines`; raises as `parse_numbers`."""
    lines: list[int] = []
    rows: list[list[float]] = []
    for line, text in numbered:
        rows.append(parse_numbers(text.split(delimiter), names, path=path, line=line))
        lines.append(line)
    return lines, np.array(rows).reshape(-1, len(names))


def parse_numbers(
    fields: Sequence[str], names: Sequence[str], *, path: Path, line: int
) -> list[float]:
    """Finite numbers of one row, one for each column name.

    Raises `InputError` if the row has more or fewer columns, or one is not a finite number.
    """
    if len(fields) != len(names):
        message = (
            f"expected {len(names)} columns ({' '.join(names)}), got {len(fields)}; "
            "complete or remove the row"
        )
        raise InputError(message, path=path, line=line)
    try:
        numbers = list(map(float, fields))
    except ValueError:
        numbers = [math.nan]
    if not all(map(math.isfinite, numbers)):
        name, field = next(pair for pair in zip(names, fields, strict=True) if not _finite(pair[1]))
        message = (
            f"expected a finite number for {name}, got {field[:40]!r}; correct or remove the row"
        )
        raise InputError(message, path=path, line=line)
    return numbers


def _finite(field: str) -> bool:
    try:
        return math.isfinite(float(field))
    except ValueError:
        return False
