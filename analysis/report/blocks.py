"""What a page is made of: sections, each of charts, tables, tiles and paragraphs.

A block names by its `kind` the macro of ``templates/blocks.html`` that turns it into HTML; none of
its text is HTML.
"""

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from .palette import Ink
from .plots import Plot, Plots


@dataclass(frozen=True, slots=True)
class Cell:
    """A text with what surrounds it.

    Attributes
    ----------
    small : below the text, in small letters
    tone : how it is set
    hint : shown under the pointer
    ink : of the mark before the text
    tags : framed words behind it
    value : by which a table is sorted, where it is not the text
    link : address of a page beside this one, which the text leads to
    """

    text: str
    small: str = ""
    tone: Literal["", "best", "equal"] = ""
    hint: str = ""
    ink: Ink | None = None
    tags: tuple[str, ...] = ()
    value: float | None = None
    link: str = ""


@dataclass(frozen=True, slots=True)
class Across:
    """A row of one cell: a heading of a group of rows, or a text about the row above."""

    across: Cell | str
    style: Literal["group", "text"]


@dataclass(frozen=True, slots=True)
class Table:
    """A table, which scrolls where it is too wide; the first cell of a row is its heading.

    Attributes
    ----------
    style : "texts" of sentences, which wrap and keep a width at which they can be read
    name : of a table that a reader can sort by its columns; unique on its page
    folded : text that stands for the table until it is opened
    """

    kind: ClassVar = "table"
    heads: Sequence[Cell | str]
    rows: Sequence[Sequence[Cell | str] | Across]
    style: Literal["", "facts", "metrics", "ranking", "texts"] = ""
    name: str = ""
    folded: str = ""


@dataclass(frozen=True, slots=True)
class Paragraph:
    """A text in a tone of voice."""

    kind: ClassVar = "paragraph"
    text: str
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Command:
    """A line to paste, with a button that copies it."""

    kind: ClassVar = "command"
    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Terms:
    """Words and what they mean; folded on a screen, open in print."""

    kind: ClassVar = "terms"
    title: str
    terms: Sequence[tuple[str, str]]


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


@dataclass(frozen=True, slots=True)
class Choice:
    """Plots of which a reader chooses one by its name, at first the first."""

    kind: ClassVar = "choice"
    name: str
    title: str
    options: Sequence[tuple[str, Plot]]


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that belongs to a policy, which the legend of the page rules.

    Attributes
    ----------
    png : bytes
    name : with its ink
    alt : what it shows, for who cannot see it
    caption : below it
    """

    png: bytes
    name: Cell
    alt: str
    caption: str

    @property
    def base64(self) -> str:
        """The bytes as an address of data has them."""
        return b64encode(self.png).decode()


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures of a scene, as many beside each other as fit, with the key of their colours."""

    kind: ClassVar = "pictures"
    pictures: Sequence[Picture]


Block = Table | Plots | Choice | Paragraph | Command | Terms | Tiles | Pictures


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page under a heading.

    Attributes
    ----------
    note : how to read it
    folded : whether it shows its heading alone until it is opened
    takeaway : the sentence that a reader should take from it
    """

    title: str
    note: str
    blocks: Sequence[Block]
    folded: bool = False
    takeaway: str = ""
