"""The table inside a log file: encoding, header, delimiter, rows of numbers.

Rows are parsed by Arrow; only where Arrow refuses does a slower pass in Python find the line at
fault and say what is wrong with it.
"""

import csv
import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.files.text_file import read_text

# What tools write where they measured nothing; a 0 is a number here and judged later.
MISSING = ("", "NA", "N/A", "n/a", "nan", "NaN", "NAN", "-nan", "null", "NULL", "None", "-")

_DELIMITERS = (",", ";", "\t")
_COMMENTS = ("#", "//")


@dataclass(frozen=True, slots=True)
class LogTable:
    r"""Header and undivided rows of a log.

    Attributes
    ----------
    header : names as in the file, without surrounding spaces
    comments : lines before the header, without their mark
    body : UTF-8, lines ending in ``\n``
    first_line : line of the file on which `body` starts
    ragged : whether a row may be shorter or longer than the header
    """

    path: Path
    header: tuple[str, ...]
    comments: tuple[str, ...]
    delimiter: str
    body: bytes
    first_line: int
    ragged: bool = False

    def numbers(self, columns: Sequence[int]) -> FloatArray:
        """Return columns by index as numbers, (rows, len(columns)), NaN where missing.

        Raises
        ------
        InputError
            At the first row that has another number of columns, or holds no number in one asked
            for; or if there are no rows.
        """
        if not self.body.strip():
            message = "expected rows below the header, got none; was the capture stopped at once?"
            raise InputError(message, path=self.path, line=max(self.first_line - 1, 1))
        fast = None if self.ragged else arrow_numbers(self, columns)
        return exact_numbers(self, columns) if fast is None else fast

    def texts(self, column: int) -> list[str]:
        """Return a column as text, '' where a ragged row lacks it; raises InputError."""
        return [row[column] if column < len(row) else "" for _, row in self.rows()]

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line number and fields of each row that is not blank; raises InputError."""
        lines = self.body.decode("utf-8").split("\n")
        for line, text in enumerate(lines, self.first_line):
            if text.strip():
                fields = _fields(text, self.delimiter, self.path, line)
                if not self._fits(fields):
                    last = not any(rest.strip() for rest in lines[line - self.first_line + 1 :])
                    raise self._misfit(fields, line, last=last)
                yield line, fields

    def _fits(self, fields: list[str]) -> bool:
        return self.ragged or len(fields) == len(self.header)

    def _misfit(self, fields: list[str], line: int, *, last: bool) -> InputError:
        width, got = len(self.header), len(fields)
        if got == 1 and any(mark in fields[0] for mark in _DELIMITERS):
            hint = f"rows must use the delimiter of the header, {self.delimiter!r}"
        elif got < width and last:
            hint = "the file is cut off in its last row: remove that row"
        elif got > width and self.delimiter == "," and all(_digits(field) for field in fields):
            hint = "decimal commas? export numbers with a point"
        else:
            hint = "correct or remove the row"
        return InputError(
            f"expected {width} columns as in the header, got {got}; {hint}",
            path=self.path,
            line=line,
        )


def read_log_bytes(path: Path) -> bytes:
    r"""Return a text file as UTF-8 without byte order mark, with lines ending in ``\n``.

    Raises
    ------
    InputError
        As `read_text`.
    """
    return read_text(path).replace("\r\n", "\n").replace("\r", "\n").encode("utf-8")


def log_lines(data: bytes, count: int) -> list[str]:
    """Return the first `count` lines of a file's bytes."""
    return [line.decode("utf-8") for line in data.split(b"\n", count)[:count]]


def split_table(data: bytes, path: Path, *, skip: int = 0) -> LogTable:
    """Find the header after `skip` lines and any comments and blank lines.

    Raises `InputError` if there is no header, or it holds no delimiter.
    """
    rest, line = data, 1
    comments: list[str] = []
    while rest:
        raw, _, rest = rest.partition(b"\n")
        text = raw.decode("utf-8").strip()
        line += 1
        if line <= skip + 1 or not text:
            continue
        if text.startswith(_COMMENTS):
            comments.append(text.lstrip("#/").strip())
            continue
        return _headed(text, tuple(comments), rest, line, path)
    raise InputError("expected a header row, got only comments", path=path, line=line - 1)


def _headed(
    text: str, comments: tuple[str, ...], body: bytes, first_line: int, path: Path
) -> LogTable:
    delimiter = max(_DELIMITERS, key=text.count)
    line = first_line - 1
    if delimiter not in text:
        message = "expected columns separated by commas, semicolons or tabs"
        raise InputError(f"{message}, got {text[:60]!r}", path=path, line=line)
    header = tuple(name.strip() for name in _fields(text, delimiter, path, line))
    if all(_number(name) is not None for name in header):
        message = f"expected a header row with names, got numbers ({text[:40]}); add the header"
        raise InputError(message, path=path, line=line)
    return LogTable(path, header, comments, delimiter, body, first_line)


def _fields(text: str, delimiter: str, path: Path, line: int) -> list[str]:
    if '"' not in text:
        return text.split(delimiter)
    try:
        return next(csv.reader([text], delimiter=delimiter))
    except csv.Error as error:
        message = f"expected a row of columns, got {error}; correct or remove the row"
        raise InputError(message, path=path, line=line) from error


def _digits(field: str) -> bool:
    return re.fullmatch(r"\s*-?\d+\s*", field) is not None


def _number(field: str) -> float | None:
    text = field.strip()
    if text in MISSING:
        return np.nan
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def exact_numbers(table: LogTable, columns: Sequence[int]) -> FloatArray:
    """Return the numbers of a table, row by row; the exact and slow way."""
    values = array("d")
    for line, fields in table.rows():
        for column in columns:
            field = fields[column] if column < len(fields) else ""
            number = _number(field)
            if number is None:
                comma = re.fullmatch(r"\s*-?\d+,\d+\s*", field)
                hint = "it has a decimal comma: export with a point" if comma else "correct it"
                message = (
                    f"expected a number in column {table.header[column]}, got {field[:40]!r}; "
                    f"{hint}"
                )
                raise InputError(message, path=table.path, line=line)
            values.append(number)
    return np.array(values, dtype=np.float64).reshape(-1, len(columns))


def arrow_numbers(table: LogTable, columns: Sequence[int]) -> FloatArray | None:
    """Return the numbers of a table by Arrow, or None where a row is not as it should be."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    names = [str(index) for index in range(len(table.header))]
    wanted = [names[index] for index in columns]
    source: Any = pa.BufferReader(table.body)
    try:
        rows: Any = arrow_csv.read_csv(
            source,
            read_options=arrow_csv.ReadOptions(column_names=names),
            # A stray quote would join rows; the exact way reads what is quoted.
            parse_options=arrow_csv.ParseOptions(delimiter=table.delimiter, quote_char=False),
            convert_options=arrow_csv.ConvertOptions(
                include_columns=wanted,
                column_types=dict.fromkeys(wanted, pa.float64()),
                null_values=list(MISSING),
            ),
        )
    except pa.ArrowInvalid:
        return None
    values = np.empty((rows.num_rows, len(wanted)))
    for place, name in enumerate(wanted):
        values[:, place] = rows.column(name).to_numpy()
    return values
