"""Numbers as people's tools write them: what is a number, what is missing, and what is neither.

A cell that is neither is missing too, and is counted and named, so that nobody believes that all
frames were measured.
"""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite, nan

# What tools write where they measured nothing; a 0 is a number here and judged later.
MISSING = ("", "NA", "N/A", "n/a", "nan", "NaN", "NAN", "-nan", "null", "NULL", "None", "-")

# Two groups, or a group and a point, can only be thousands; other than three digits, decimals.
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3}){2,}(?:\.\d*)?|[+-]?\d{1,3}(?:,\d{3})+\.\d*")
_DECIMAL = re.compile(r"[+-]?(?:\d*,(?:\d{1,2}|\d{4,})|0,\d+|\d{4,},\d{3})(?:[eE][+-]?\d+)?")
_EITHER = re.compile(r"[+-]?\d{1,3},\d{3}")
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:[  '_’\u2009\u202f]\d{3})+(?:[.,]\d+)?")
_SEPARATORS = re.compile(r"[  '_’\u2009\u202f]")


def comma_style(cells: Sequence[str], delimiter: str) -> str:
    """Return "decimal" or "thousands": what a comma within cells is.

    Where only such as ``7,459`` occur, it is the decimal mark of who separates by another, and
    thousands where commas separate and so the cell was quoted.
    """
    with_comma = [cell for cell in cells if "," in cell]
    if any(_DECIMAL.fullmatch(cell) for cell in with_comma):
        return "decimal"
    if any(_THOUSANDS.fullmatch(cell) for cell in with_comma):
        return "thousands"
    return "thousands" if delimiter == "," else "decimal"


def number_of(cell: str, commas: str) -> float | None:
    """Return the number in a cell, NaN where it says that there is none, None where it is neither.

    An infinite number is neither.
    """
    text = cell.strip()
    if text in MISSING:
        return nan
    if "," in text:
        text = text.replace(",", "." if commas == "decimal" else "") if _has_comma(text) else text
    if _GROUPED.fullmatch(text):
        text = _SEPARATORS.sub("", text)
    if "_" in text:  # Python's own separator, which no tool writes
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) else None


def _has_comma(text: str) -> bool:
    patterns = (_THOUSANDS, _DECIMAL, _EITHER)
    return any(pattern.fullmatch(text) for pattern in patterns)


@dataclass(slots=True)
class OddCells:
    """Cells that were to hold numbers and did not, counted by column, each with an example."""

    counts: Counter[str] = field(default_factory=Counter[str])
    examples: dict[str, str] = field(default_factory=dict[str, str])

    def add(self, column: str, cell: str, count: int = 1) -> None:
        """Count a cell of a column."""
        self.counts[column] += count
        self.examples.setdefault(column, cell.strip()[:24])

    def notes(self) -> tuple[str, ...]:
        """Return a sentence for each column."""
        return tuple(
            f"{count:,} {'cell' if count == 1 else 'cells'} of {column} "
            f"{'is' if count == 1 else 'are'} no number, such as {self.examples[column]!r}: missing"
            for column, count in self.counts.items()
        )
