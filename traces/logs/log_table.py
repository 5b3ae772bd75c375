"""The table inside a log file: encoding, header, delimiter, rows of numbers.

Rows are parsed by Arrow; where Arrow refuses, a slower pass in Python takes what there is.  Cells
that are no numbers are missing values and rows may be of any length, but both are counted, and so
are headers that stand again between the rows, as where captures were appended.
"""

import csv
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.files.text_file import read_text
from .columns.column_roles import role_of
from .log_cells import MISSING, OddCells, comma_style, number_of

MOST_CELLS = 30_000_000
"""Numbers that a log may hold: at 240 Hz, five columns of seven hours; 0.24 GB, and copies."""

_DELIMITERS = (",", ";", "\t")
_COMMENTS = ("#", "//")
_SAMPLED = 200  # rows that are looked at to learn how a file writes


@dataclass(frozen=True, slots=True)
class LogTable:
    r"""Header and undivided rows of a log.

    Attributes
    ----------
    header : names as in the file, without surrounding spaces
    comments : lines before the header, without their mark
    body : UTF-8, lines ending in ``\n``
    first_line : line of the file on which `body` starts
    ragged : whether the tool itself writes rows shorter than the header
    """

    path: Path
    header: tuple[str, ...]
    comments: tuple[str, ...]
    delimiter: str
    body: bytes
    first_line: int
    ragged: bool = False

    def numbers(self, columns: Sequence[int]) -> FloatArray:
        """Return columns by index as numbers, (rows, len(columns)); as `measure`, without notes."""
        return self.measure(columns)[0]

    def measure(self, columns: Sequence[int]) -> tuple[FloatArray, tuple[str, ...]]:
        """Return columns by index as numbers, (rows, len(columns)), and what was odd about them.

        NaN is missing, or no finite number.

        Raises
        ------
        InputError
            If there are no rows, none holds a number, they are too many, or numbers are written
            with commas between columns that commas separate.
        """
        if not self.body.strip():
            message = "expected rows below the header, got none; was the capture stopped at once?"
            raise InputError(message, path=self.path, line=max(self.first_line - 1, 1))
        rows = self.body.count(b"\n") + 1
        if rows * len(columns) > MOST_CELLS:
            message = (
                f"expected at most {MOST_CELLS:,} numbers, got {rows:,} rows of {len(columns)}"
            )
            raise InputError(f"{message}; split the log", path=self.path)
        fast = None if self.ragged else arrow_numbers(self, columns)
        if fast is None:
            return exact_numbers(self, columns)
        odd = OddCells()
        for place, column in enumerate(columns):
            infinite = np.isinf(fast[:, place])
            if infinite.any():
                odd.add(self.header[column], "inf", int(infinite.sum()))
                fast[infinite, place] = np.nan
        return fast, odd.notes()

    def texts(self, column: int) -> list[str]:
        """Return a column as text, '' where a row lacks it."""
        return [row[column] if column < len(row) else "" for _, row in self.rows()]

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line number and fields of each row that is not blank and not the header again."""
        again = [name.lower() for name in self.header[:4]]
        for line, text in enumerate(self.body.decode("utf-8").split("\n"), self.first_line):
            if text.strip():
                fields = _fields(text, self.delimiter)
                if [field.strip().lower() for field in fields[:4]] != again:
                    yield line, fields

    def sample(self) -> list[list[str]]:
        """Return the fields of some rows from the beginning, the middle and the end."""
        lines = self.body.decode("utf-8").split("\n")
        third = _SAMPLED // 3
        middle = len(lines) // 2
        picked = (
            lines
            if len(lines) <= _SAMPLED
            else [*lines[:third], *lines[middle : middle + third], *lines[-third:]]
        )
        return [_fields(text, self.delimiter) for text in picked if text.strip()]

    def numeric(self, columns: Sequence[int]) -> list[int]:
        """Return those of some columns, by index, that hold numbers wherever they hold anything."""
        rows = [row for row in self.sample() if len(row) > 1]
        return [column for column in columns if _is_numeric(rows, column, self.delimiter)]


def _is_numeric(rows: Sequence[Sequence[str]], column: int, delimiter: str) -> bool:
    cells = [row[column].strip() for row in rows if column < len(row)]
    told = [cell for cell in cells if cell not in MISSING]
    commas = comma_style(told, delimiter)
    numbers = sum(number_of(cell, commas) is not None for cell in told)
    return bool(told) and numbers > 0.8 * len(told)


def repeated_headers(table: LogTable) -> list[int]:
    """Return the lines on which the header stands again: another capture was appended there."""
    start = table.delimiter.join(table.header[:3]).lower().encode()
    lines = table.body.split(b"\n")
    return [
        line for line, text in enumerate(lines, table.first_line) if text.lower().startswith(start)
    ]


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
    if delimiter not in text and role_of(text) is None:  # one column of times needs no mark
        message = "expected columns separated by commas, semicolons or tabs"
        raise InputError(f"{message}, got {text[:60]!r}", path=path, line=line)
    names = [name.strip() for name in _fields(text, delimiter)]
    while len(names) > 1 and not names[-1]:  # a delimiter at the end of each row
        names.pop()
    header = tuple(names)
    if all(number_of(name, "thousands") is not None for name in header):
        message = f"expected a header row with names, got numbers ({text[:40]}); add the header"
        raise InputError(message, path=path, line=line)
    return LogTable(path, header, comments, delimiter, body, first_line)


def _fields(text: str, delimiter: str) -> list[str]:
    if '"' not in text:
        return text.split(delimiter)
    try:
        return next(csv.reader([text], delimiter=delimiter))
    except csv.Error:  # a field of megabytes
        return text.split(delimiter)


def exact_numbers(table: LogTable, columns: Sequence[int]) -> tuple[FloatArray, tuple[str, ...]]:
    """Return the numbers of a table, row by row, and what was odd; the exact and slow way."""
    width = require_columns(table)
    table, cut = _without_cut_row(table)
    needed = max(columns, default=-1) + 1
    commas = comma_style(
        [row[c].strip() for row in table.sample() for c in columns if c < len(row)],
        table.delimiter,
    )
    values, odd, short, aside, rows = array("d"), OddCells(), 0, 0, 0
    for _, fields in table.rows():
        rows += 1
        if not table.ragged:
            # A word between the rows is no frame; a row with too many numbers is of unsure columns.
            if len(fields) < min(needed, 2) or (len(fields) > width and is_shifted(fields, width)):
                aside += 1
                continue
            short += len(fields) < needed
        for column in columns:
            field = fields[column] if column < len(fields) else ""
            try:
                number = number_of(field, commas) if "_" in field else float(field)
            except ValueError:
                number = number_of(field, commas)
            if number is None or number - number != 0.0:
                if number is None or field.strip() not in MISSING:
                    odd.add(table.header[column], field)
                number = np.nan
            values.append(number)
    array_of = np.array(values, dtype=np.float64).reshape(-1, len(columns))
    kept, notes = _kept(table, array_of, columns, odd)
    if short:
        notes.append(f"{short:,} of {rows:,} rows lack columns that are needed: missing values")
    if aside:
        notes.append(f"{aside:,} of {rows:,} rows have too few or too many columns: left aside")
    return kept, (*notes, *cut)


def _without_cut_row(table: LogTable) -> tuple[LogTable, tuple[str, ...]]:
    """Leave aside a last row that ends in the middle, whose last number may be cut too."""
    before, _, last = table.body.rpartition(b"\n")
    above = before.rpartition(b"\n")[2].decode("utf-8")
    width = len(_fields(last.decode("utf-8"), table.delimiter))
    if table.ragged or not last.strip() or width >= len(table.header) or not above.strip():
        return table, ()
    if len(_fields(above, table.delimiter)) <= width:
        return table, ()
    return replace(table, body=before + b"\n"), ("the last row is cut off and left aside",)


def _kept(
    table: LogTable,
    values: FloatArray,
    columns: Sequence[int],
    odd: OddCells,
) -> tuple[FloatArray, list[str]]:
    notes = list(odd.notes())
    repeated = len(repeated_headers(table))
    if repeated:
        notes.append(f"the header stands {repeated} more times between the rows: captures appended")
    if not len(values) or (columns and not np.isfinite(values).any()):
        name = table.header[columns[0]] if columns else ""
        got = f"got such as {odd.examples[name]!r}" if name in odd.examples else "got none"
        message = f"expected numbers in column {name}, {got}; is it the right column?"
        raise InputError(message, path=table.path, line=table.first_line)
    return values, notes


def require_columns(table: LogTable) -> int:
    """Return the width of rows that are in order.

    Raises `InputError` if most rows have columns that cannot be told apart: they are separated by
    another mark than the header's, or hold commas of numbers between the commas of columns.
    """
    width, rows = len(table.header), table.sample()
    marks = [mark for mark in _DELIMITERS if mark != table.delimiter]
    single = [row for row in rows if len(row) == 1 and any(mark in row[0] for mark in marks)]
    expected = f"expected {width} columns as in the header"
    if len(single) > len(rows) // 2:
        hint = f"rows must use the delimiter of the header, {table.delimiter!r}"
        raise InputError(f"{expected}, got 1; {hint}", path=table.path, line=table.first_line)
    longer = [row for row in rows if is_shifted(row, width)]
    if len(longer) <= len(rows) // 2 or not longer:
        return width
    if table.delimiter != ",":
        return max(len(row) for row in longer)  # columns without a name
    hint = "decimal commas, or thousands? export numbers with a point and no commas"
    raise InputError(
        f"{expected}, got {len(longer[0])}; {hint}", path=table.path, line=table.first_line
    )


def is_shifted(fields: Sequence[str], width: int) -> bool:
    """Return whether a row has more numbers than the header has names, so that none is sure."""
    return any(
        field.strip() and number_of(field, "thousands") is not None for field in fields[width:]
    )


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
