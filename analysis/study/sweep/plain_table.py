"""A table of a study's results, printed to a terminal, as CSV, or as LaTeX."""

import csv
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...report.console_tables import titled_table
from ...report.values import ABSENT, format_value
from ..axes.grid import Cell

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.table import Table

_LATEX = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "–": "--",
    "…": r"\ldots{}",
} | {mark: f"\\{mark}" for mark in "&%$#_{}"}


_FRAME = 3
"""Characters of a column beside its cells: a line and two spaces."""


@dataclass(frozen=True, slots=True)
class PlainTable:
    """Rows under a header.

    Attributes
    ----------
    title : str
    header : tuple of str
    rows : list of tuple of Cell
    texts : tuple of str
        Columns of names rather than of numbers.
    axes : tuple of str
        Columns whose numbers were given, and are shown as they were.
    """

    title: str
    header: tuple[str, ...]
    rows: list[tuple[Cell, ...]]
    texts: tuple[str, ...]
    axes: tuple[str, ...] = ()

    def shown(self) -> Iterator[list[str]]:
        """Yield the rows as texts, measured numbers in three digits."""
        for row in self.rows:
            yield [
                _as_given(cell) if name in self.axes else _short(cell)
                for name, cell in zip(self.header, row, strict=True)
            ]


def console_table(table: PlainTable) -> "Table":
    """Return a table for a terminal."""
    from rich.text import Text

    shown = titled_table(table.title, table.header, table.texts)
    for row in table.shown():
        shown.add_row(*map(Text, row))
    return shown


def fitting(table: PlainTable, width: int) -> list[PlainTable]:
    """Return a table as several, each with the columns of names and as many others as fit.

    Parameters
    ----------
    width
        Of the terminal, in characters.
    """
    lines = [table.header, *table.shown()]
    wide = [_FRAME + max(map(len, column)) for column in zip(*lines, strict=True)]
    named = {*table.texts, *table.axes}
    fixed = [at for at, name in enumerate(table.header) if name in named]
    groups: list[list[int]] = [[]]
    room = free = width - 1 - sum(wide[at] for at in fixed)
    for at in (at for at, name in enumerate(table.header) if name not in named):
        if wide[at] > room and groups[-1]:
            groups.append([])
            room = free
        groups[-1].append(at)
        room -= wide[at]
    return [_with_columns(table, sorted((*fixed, *group))) for group in groups]


def _with_columns(table: PlainTable, places: Sequence[int]) -> PlainTable:
    header = tuple(table.header[at] for at in places)
    rows = [tuple(row[at] for at in places) for row in table.rows]
    return replace(table, header=header, rows=rows)


def csv_text(table: PlainTable) -> str:
    """Return RFC 4180 text with every digit of every number; what is not there is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table.header)
    writer.writerows([_exact(cell) for cell in row] for row in table.rows)
    return text.getvalue()


def latex_text(table: PlainTable) -> str:
    """Return a ``tabular`` for the package booktabs, its title as a comment above."""
    columns = "".join("l" if name in table.texts else "r" for name in table.header)
    lines = [f"% {table.title}", rf"\begin{{tabular}}{{{columns}}}", r"\toprule"]
    lines += [_latex_row(table.header), r"\midrule"]
    lines += [_latex_row(row) for row in table.shown()]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


def _latex_row(cells: Sequence[str]) -> str:
    return f"{' & '.join(map(_escaped, cells))} \\\\"


def _escaped(text: str) -> str:
    return re.sub(r"[\\~^–…&%$#_{}]", lambda mark: _LATEX[mark[0]], text)


def _as_given(cell: Cell) -> str:
    if cell is None:
        return ABSENT
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)


def _short(cell: Cell) -> str:
    return format_value(cell) if cell is None or isinstance(cell, float) else str(cell)


def _exact(cell: Cell) -> str:
    if cell is None:
        return ""
    return repr(cell) if isinstance(cell, float) else str(cell)
