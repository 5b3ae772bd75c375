"""Errors of lodbench, a leaf module.

::

    LodbenchError
    ├── InputError        what was given cannot be used (exit code 2)
    └── PolicyError       a policy broke its contract in some frame (exit code 1)

A message says what was expected, what was found, where, and what to do.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from numbers import Real
from pathlib import Path
from typing import SupportsIndex, TypeVar

Kind = TypeVar("Kind")


LONGEST = 300
"""Characters of a line with the name of its file; of a longer message the middle is left out."""

_END_SHARE = 0.6
_SHORTEST = 160  # however long the name of the file is
_PREFIX = len("error: ")


def printable(text: str) -> str:
    """Return a text in which what moves a terminal's cursor or hides text has become ``?``."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _in_one_line(message: str) -> str:
    return _cut(printable(" ".join(message.split())), LONGEST)  # libraries explain in several lines


def _cut(line: str, longest: int) -> str:
    end = int(longest * _END_SHARE)
    return line if len(line) <= longest else f"{line[: longest - end - 3]} … {line[-end:]}"


class LodbenchError(Exception):
    """Base of every error that lodbench raises on purpose."""


class InputError(LodbenchError):
    """Input that cannot be used; ``str()`` is the one line that the command line prints."""

    def __init__(
        self,
        message: str,
        *,
        path: str | Path | None = None,
        line: int | None = None,
    ) -> None:
        self.message = _in_one_line(message)
        self.path = None if path is None else str(path)
        self.line = line
        super().__init__(self.message)  # pickles: path and line travel with the attributes

    def __str__(self) -> str:
        where = "" if self.path is None else f"{printable(self.path)}:"
        where += "" if self.line is None else f"{self.line}:"
        room = max(LONGEST - _PREFIX - len(where) - 1, _SHORTEST)
        return f"{where} {_cut(self.message, room)}".strip()


@contextmanager
def about_file(path: str | Path) -> Generator[None]:
    """Name the file in every InputError of the block that names none."""
    try:
        yield
    except InputError as error:
        if error.path is not None:
            raise
        raise InputError(error.message, path=path, line=error.line) from error


@contextmanager
def about_users_code(function: object, name: str, path: str | Path) -> Generator[None]:
    """Turn what a user's function raises in the block into InputError; ours are left alone.

    Parameters
    ----------
    name
        What the user calls the thing that the function is of.
    path
        The file that the function was given.
    """
    if str(getattr(function, "__module__", "")).startswith("lodbench."):
        yield
        return
    try:
        with about_file(path):
            yield
    except LodbenchError:
        raise
    except Exception as error:
        reason = [type(error).__name__, *str(error).strip().splitlines()[:1]]
        raise InputError(f"{name}: {': '.join(reason)}", path=path) from error


def require_kind(value: object, kind: type[Kind], name: str, path: str | Path) -> Kind:
    """Return what a user's reader made of a file; raises InputError if it is of another kind."""
    if isinstance(value, kind):
        return value
    message = f"{name}: expected a {kind.__name__}, got {type(value).__name__}"
    raise InputError(f"{message}; return one from read", path=path)


def text_of(given: object, what: str, kind: type) -> str:
    """Return what names a thing as text; raises InputError unless it is a string or a path."""
    if isinstance(given, (str, os.PathLike)):
        return os.fsdecode(given)  # pyright: ignore[reportUnknownArgumentType]
    expected = f"expected a name, a path or a {kind.__name__}"
    raise InputError(f"{what}: {expected}, got {type(given).__name__}; give one of these")


def is_file(path: Path) -> bool:
    """Whether a path leads to a file; one that is too long, or may not be looked at, does not."""
    with suppress(OSError):
        return path.is_file()
    return False


def require_between(value: float, low: float, high: float, name: str) -> None:
    """Raise InputError unless ``low <= value <= high``; an infinite `high` is no bound."""
    if not low <= value <= high:
        expected = f"at least {low}" if high == float("inf") else f"{low} to {high}"
        raise InputError(f"{name}: expected {expected}, got {value}")


def require_whole(value: object, name: str, low: int | None = None) -> None:
    """Raise InputError unless a value is a whole number, of at least `low` if that is given."""
    whole: int | None = None
    if type(value) is int:  # asked first: to ask for a protocol takes some ten times as long
        whole = value
    elif isinstance(value, SupportsIndex) and not isinstance(value, bool):
        whole = int(value)
    if whole is not None and (low is None or whole >= low):
        return
    bound = "" if low is None else f" >= {low}"
    raise InputError(f"{name}: expected a whole number{bound}, got {value}")


def require_real(value: object, name: str) -> None:
    """Raise InputError unless a value is a real number, no truth value."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(f"{name}: expected a number, got {value!r}")


class PolicyError(LodbenchError):
    """A policy raised, or returned a selection that breaks its contract."""

    def __init__(self, policy: str, frame: int | None, reason: str) -> None:
        self.policy = policy
        self.frame = frame
        self.reason = reason
        super().__init__(policy, frame, reason)

    def __str__(self) -> str:
        where = "reset" if self.frame is None else f"frame {self.frame}"
        return f"policy {self.policy}, {where}: {self.reason}"
