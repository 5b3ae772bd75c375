"""Annotations that GitHub Actions shows beside a change.

Syntax: GitHub's "Workflow commands for GitHub Actions"; a value escapes ``%``, line ends, and in
properties also ``:`` and ``,``.
"""

from collections.abc import Iterator
from pathlib import Path

from .check_result import CheckReport
from .plain_text import describe

_DATA = {"%": "%25", "\r": "%0D", "\n": "%0A"}
_PROPERTY = {**_DATA, ":": "%3A", ",": "%2C"}


def annotations(report: CheckReport, limits: Path | None) -> Iterator[str]:
    """Yield an error for each failure, a warning for each other undecided limit."""
    for verdict in report.verdicts:
        failure = report.is_failure(verdict)
        if not failure and verdict.outcome != "undecided":
            continue
        properties = {"title": f"{verdict.metric} of {verdict.policy}"}
        if limits is not None and verdict.line is not None:
            properties |= {"file": limits.as_posix(), "line": str(verdict.line)}
        named = ",".join(f"{key}={_escape(text, _PROPERTY)}" for key, text in properties.items())
        yield f"::{'error' if failure else 'warning'} {named}::{_escape(describe(verdict), _DATA)}"


def _escape(text: str, table: dict[str, str]) -> str:
    return text.translate(str.maketrans(table))
