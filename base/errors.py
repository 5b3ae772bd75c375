"""Errors of lodbench, a leaf module.

::

    LodbenchError
    ├── InputError        what was given cannot be used (exit code 2)
    └── PolicyError       a policy broke its contract in some frame (exit code 1)

A message says what was expected, what was found, where, and what to do.
"""

import re
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path


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
        self.message = re.sub(r"\s*\n\s*", " ", message)  # libraries explain in several lines
        self.path = None if path is None else str(path)
        self.line = line
        super().__init__(self.message)  # pickles: path and line travel with the attributes

    def __str__(self) -> str:
        where = "" if self.path is None else f"{self.path}:"
        where += "" if self.line is None else f"{self.line}:"
        return f"{where} {self.message}".strip()


@contextmanager
def about_file(path: str | Path) -> Generator[None]:
    """Name the file in every InputError of the block that names none."""
    try:
        yield
    except InputError as error:
        if error.path is not None:
            raise
        raise InputError(error.message, path=path, line=error.line) from error


def require_between(value: float, low: float, high: float, name: str) -> None:
    """Raise InputError unless ``low <= value <= high``; an infinite `high` is no bound."""
    if not low <= value <= high:
        expected = f"at least {low}" if high == float("inf") else f"{low} to {high}"
        raise InputError(f"{name}: expected {expected}, got {value}")


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
