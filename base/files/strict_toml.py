"""TOML files read strictly: every mistake is told with its key and line.

A place in a document is its dotted path, such as ``gpu.linear.triangles``; tables of an array count
from 0, as in ``for.0.policy``.
"""

import dataclasses
import re
import tomllib
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn, TypeVar, cast

import msgspec

from ..errors import InputError
from ..nearest_names import unknown_name
from .text_file import read_text

Record = TypeVar("Record")

_NAME = r"""(?:[\w-]+|"(?:\\.|[^"\\])*"|'[^']*')"""
_NAMES = rf"{_NAME}(?:\s*\.\s*{_NAME})*"
_HEADER = re.compile(rf"\s*(?P<open>\[\[?)\s*(?P<names>{_NAMES})\s*\]")
_KEY = re.compile(rf"\s*(?P<names>{_NAMES})\s*=")
_QUOTES = "\"'"
# What decides where a statement ends: brackets and line ends outside of strings and comments.
_TOKEN = re.compile(
    r"""(?sx) \"{3} (?:\\.|[^\\])*? \"{3,5} | '{3} .*? '{3,5}
    | "(?:\\.|[^"\\\n])*" | '[^'\n]*' | \#[^\n]* | [\[\]{}] | \n"""
)


@dataclasses.dataclass(frozen=True)
class TomlDocument:
    """The text of a TOML file, its content, and on which line each key stands.

    Raises `InputError` if the text is no TOML.
    """

    text: str
    path: Path | None = None

    @cached_property
    def content(self) -> dict[str, Any]:
        """The document as dicts and lists."""
        try:
            return tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            what, _, place = str(error).partition(" (at ")
            at = re.match(r"line (\d+)", place)
            line = int(at[1]) if at else self.text.count("\n") + 1
            raise InputError(f"expected TOML, got: {what}", path=self.path, line=line) from error
        except RecursionError as error:
            message = "expected TOML, got brackets nested too deep"
            raise InputError(message, path=self.path) from error

    def fail(self, where: str, message: str) -> NoReturn:
        """Raise InputError about the key or table at `where`."""
        named = not where or message.startswith(where.rpartition(".")[2])
        label = "" if named else re.sub(r"\.(\d+)(?=\.|$)", r"[\1]", where) + ": "
        raise InputError(label + message, path=self.path, line=self.line_of(where))

    def line_of(self, where: str) -> int | None:
        """Return the line of the deepest part of `where` that the text holds, if any."""
        while where and where not in self._lines:
            where = where.rpartition(".")[0]
        return self._lines.get(where)

    def table(self, table: Any, keys: Iterable[str], where: str) -> dict[str, Any]:
        """Return `table`, checked to be a table that has no other keys than these."""
        if not isinstance(table, dict):
            self.fail(where, f"expected a table, got {type(table).__name__}")
        keys = list(keys)
        for key in cast("dict[str, Any]", table):
            if key not in keys:
                self.fail(f"{where}.{key}".lstrip("."), unknown_name(key, keys))
        return cast("dict[str, Any]", table)

    def record(self, table: Any, kind: type[Record], where: str) -> Record:
        """Return a table as a dataclass with the same keys."""
        fields = {item.name: item.type for item in dataclasses.fields(cast("Any", kind))}
        table = self.table(table, fields, where)
        try:
            return msgspec.convert(table, kind)
        except msgspec.ValidationError as error:
            what, _, at = str(error).partition(" - at `$")
            key = re.sub(r"\[.*", "", at.rstrip("`"))
            missing = re.fullmatch(r"Object missing required field `(\w+)`", what)
            if missing:
                self.fail(where, f"expected the key {missing[1]}, found none; add it")
            what = what.replace("`", "")
            enum = re.match(r"Invalid enum value '(.*)'", what)
            if enum:
                choices = map(str, cast("Any", fields[key[1:]]).__args__)
                self.fail(where + key, unknown_name(enum[1], choices))
            self.fail(where + key, what[0].lower() + what[1:])
        except InputError as error:
            self.fail(where, error.message)

    @cached_property
    def _lines(self) -> dict[str, int]:
        lines: dict[str, int] = {}
        last: dict[str, int] = {}  # index of the latest table of each array of tables
        table = ""
        for line, statement in _statements(self.text):
            header = _HEADER.match(statement)
            key = header or _KEY.match(statement)
            if key is None:  # blank, or nothing but a comment
                continue
            at = "" if header else table
            for name in re.findall(_NAME, key["names"]):
                at += f".{last[at]}" if at in last else ""
                at = f"{at}.{name.strip(_QUOTES)}".lstrip(".")
                lines.setdefault(at, line)
            if header:
                if header["open"] == "[[":
                    last[at] = last.get(at, -1) + 1
                    at += f".{last[at]}"
                    lines[at] = line
                table = at
        return lines


def read_toml(path: Path, largest_bytes: int, advice: str) -> TomlDocument:
    """Read a TOML file; raises `InputError` as `read_text`."""
    return TomlDocument(read_text(path, largest_bytes=largest_bytes, advice=advice), path)


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Return each header, and each key with its value, and the number of its first line."""
    line, first, start, depth = 1, 1, 0, 0
    for token in _TOKEN.finditer(text):
        mark = token[0]
        depth += (mark in ("[", "{")) - (mark in ("]", "}"))
        line += mark.count("\n")
        if mark == "\n" and depth == 0:
            yield first, text[start : token.start()]
            first, start = line, token.end()
    yield first, text[start:]
