"""Tables as LaTeX of the package booktabs, each a tabular to be input into a table of a paper.

What is written is ASCII but for letters of names, so that any engine with UTF-8 reads it.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from ....base.files.whole_file import write_whole
from ....base.foreign_text import one_line
from ...study.comparison import Comparison
from ..values import format_value
from .tables import Cell, Column, Estimate, PrintedTable, printed_tables

_LONGEST = 60
_LONGEST_CAPTION = 300

# What TeX reads as anything but itself, in either of its font encodings.
_ESCAPED = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "%": r"\%",
    "#": r"\#",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"{\char34}",
    "'": r"{'}",
    "`": r"{`}",
    "[": "{[}",  # after the end of a row it would be a length
    "*": "{*}",
    "…": r"\ldots{}",
    "–": "--",
}


def write_latex_tables(comparison: Comparison, folder: Path) -> list[Path]:
    """Write every table of a comparison to a folder, which is made; return the files.

    Raises `InputError` if one cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for table in printed_tables(comparison):
        written.append(folder / f"{table.name}.tex")
        write_whole(written[-1], latex_text(table))
    return written


def latex_escape(text: str, longest: int = _LONGEST) -> str:
    """Return a text as LaTeX that prints it, in one line and cut where it is longer."""
    escaped = "".join(_ESCAPED.get(letter, letter) for letter in one_line(text, longest))
    return re.sub("(?<=-)-", "{-}", escaped) if "--" in text else escaped


def latex_text(table: PrintedTable) -> str:
    """Return a tabular, under its caption as a comment; numbers have three significant digits."""
    numeric = [
        all(not isinstance(row[i], str) for row in table.rows) for i in range(len(table.columns))
    ]
    lines = [
        f"% {one_line(table.caption, _LONGEST_CAPTION)}",
        r"% \usepackage{booktabs}",
        rf"\begin{{tabular}}{{{''.join('r' if right else 'l' for right in numeric)}}}",
        r"\toprule",
        _row(map(_head, table.columns)),
        r"\midrule",
        *(_row(map(_cell, row)) for row in table.rows),
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def _head(column: Column) -> str:
    unit = f" ({column.unit})" if column.unit else ""
    return latex_escape(column.head.replace("_", " ") + unit)


def _row(cells: Iterator[str]) -> str:
    return " & ".join(cells) + r" \\"


def _cell(cell: Cell) -> str:
    if cell is None:
        return "--"
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    if isinstance(cell, str):
        return latex_escape(cell)
    if isinstance(cell, int):
        return str(cell)
    if not isinstance(cell, Estimate):
        return _number(cell)
    if cell.low is None or cell.high is None:
        return _number(cell.value)
    span = f"({_number(cell.low)}, {_number(cell.high)})"
    return rf"{_number(cell.value)} {{\scriptsize {span}}}"


def _number(value: float | None) -> str:
    text = format_value(value)
    return f"${text}$" if text.startswith("-") else text.replace("–", "--")
