"""What a page is made of: sections, each of charts, tables, tiles and paragraphs.

A block names by its `kind` the macro of ``templates/blocks.html`` that turns it into HTML; none of
its text is HTML.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from .palette import Ink


@dataclass(frozen=True, slots=True)
class Cell:
    """A text with what surrounds it.

    Attributes
    ----------
    small : below the text, in small letters
    best : whether it is set in green
    hint : shown under the pointer
    ink : of the mark before the text
    tags : framed words behind it
    """

    text: str
    small: str = ""
    best: bool = False
    hint: str = ""
    ink: Ink | None = None
    tags: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Across:
    """A row of one cell: a heading of a group of rows, or a text about the row above."""

    across: Cell | str
    style: Literal["group", "text"]


@dataclass(frozen=True, slots=True)
class Table:
    """A table, which scrolls where it is too wide; the first cell of a row is its heading."""

    kind: ClassVar = "table"
    heads: Sequence[Cell | str]
    rows: Sequence[Sequence[Cell | str] | Across]
    style: Literal["", "facts", "metrics", "ranks"] = ""


@dataclass(frozen=True, slots=True)
class Chart:
    """A plotly figure, or None where there is nothing to draw."""

    kind: ClassVar = "chart"
    name: str
    figure: Any


@dataclass(frozen=True, slots=True)
class Paragraph:
    """A text in a tone of voice."""

    kind: ClassVar = "paragraph"
    text: str
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Tile:
    """A question and its answer, at a glance."""

    title: str
    names: Sequence[Cell | str]
    detail: Cell | str


@dataclass(frozen=True, slots=True)
class Tiles:
    """Tiles beside each other."""

    kind: ClassVar = "tiles"
    tiles: Sequence[Tile]


Block = Table | Chart | Paragraph | Tiles


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page under a heading; a folded one shows its heading alone until it is opened."""

    title: str
    note: str
    blocks: Sequence[Block]
    folded: bool = False
