"""Tables as CSV: numbers in full, a cell left empty where there is none."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path

from ....base.files.whole_file import write_whole
from ...study.comparison import Comparison
from .tables import Cell, Estimate, PrintedTable, printed_tables


def write_csv_tables(comparison: Comparison, folder: Path) -> list[Path]:
    """Write every table of a comparison to a folder, which is made; return the files.

    Raises `InputError` if one cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for table in printed_tables(comparison):
        written.append(folder / f"{table.name}.csv")
        write_whole(written[-1], csv_text(table))
    return written


def csv_text(table: PrintedTable) -> str:
    """Return a table by RFC 4180, but with a line feed as the end of a line.

    Names are written as they are: a spreadsheet may take one that begins with ``=`` for a formula.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_heads(table))
    for row in table.rows:
        writer.writerow(_flat(row))
    # Half of a surrogate pair, which JSON may hold, is no text in UTF-8.
    return text.getvalue().encode("utf-8", "replace").decode()


def _heads(table: PrintedTable) -> Iterator[str]:
    for column in table.columns:
        head = column.head.replace(" ", "_")
        yield head
        if column.estimates:
            yield from (f"{head}_low", f"{head}_high")


def _flat(row: tuple[Cell, ...]) -> Iterator[str | float | None]:
    for cell in row:
        if isinstance(cell, Estimate):
            yield from (cell.value, cell.low, cell.high)
        else:
            yield str(cell).lower() if isinstance(cell, bool) else cell
