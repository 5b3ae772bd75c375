"""What a format of render logs is: how to recognise it and how to read it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from .render_log import RenderLog

Columns = Mapping[str, str] | None
"""Columns by the names of `render_log`: ``{"gpu_ms": "GPUTime", "triangles": "Prims"}``."""


class LogHead:
    """The first bytes of a file, by which formats recognise it."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    @cached_property
    def text(self) -> str:
        """The bytes as UTF-8, or as UTF-16 if they begin with its mark; the rest is left out."""
        marks = (b"\xff\xfe", b"\xfe\xff")
        encoding = "utf-16" if self.data.startswith(marks) else "utf-8-sig"
        return self.data.decode(encoding, "ignore").lstrip()

    @cached_property
    def lines(self) -> list[str]:
        """Lines that are not blank, without space at either end."""
        return [stripped for line in self.text.splitlines() if (stripped := line.strip())]

    @cached_property
    def header(self) -> tuple[str, ...]:
        """Names of the columns: the first line that is no comment, split."""
        row = next((line for line in self.lines if not line.startswith(("#", "//"))), "")
        delimiter = max(",;\t", key=row.count)
        return tuple(name.strip().strip('"') for name in row.split(delimiter))


@dataclass(frozen=True, slots=True)
class LogFormat:
    """One file format of render logs.

    Attributes
    ----------
    what : one line for tables
    recognises : takes the head of a file and says whether it is of this format
    read : takes a path and columns to map
    predictors : whether it can hold what was drawn, and so takes columns to map
    """

    what: str
    recognises: Callable[[LogHead], bool]
    read: Callable[[Path, Columns], RenderLog]
    predictors: bool = True
