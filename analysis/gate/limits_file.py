"""Limits as a TOML file says them."""

import difflib
import re
import tomllib
from pathlib import Path
from typing import Any, NoReturn, cast, get_args

from ...base.errors import InputError
from ..metrics.metric_registry import find_metric
from .amount import Amount, parse_amount
from .limits import Kind, Limit, Limits, Rule

DEFAULT_LIMITS = """
[limits]
work_ms_p95 = { max = "budget" }
frame_ms_p99 = { max_increase = "2.5%" }
"""
"""Limits without a file.  2.5 % lies midway between no change and the 5 % that has to be found."""

_SCOPE = ("policy", "scene", "trace")
_LARGEST_BYTES = 1 << 20


def choose_limits(path: Path | None, baseline: Path, *, updating: bool = False) -> Limits:
    """Return the limits of a file; without one `DEFAULT_LIMITS`, as far as they can be judged.

    Raises
    ------
    InputError
        As `read_limits`; or if a baseline is to be updated that no limit needs.
    """
    limits = parse_limits(DEFAULT_LIMITS) if path is None else read_limits(path)
    if updating and not limits.relative:
        raise InputError(
            "expected a limit relative to the baseline, got none; add max_increase", path=path
        )
    if path is None and not updating and not baseline.exists():
        return limits.absolute_only()
    return limits


def read_limits(path: Path) -> Limits:
    """Read a file of limits.

    Raises `InputError` if it is missing, not TOML, or not as `parse_limits` expects.
    """
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise InputError("expected limits of at most 1 MB; name another file", path=path)
        text = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(
            f"expected a TOML file of limits, got {error.strerror}; see docs/ci.md", path=path
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            "expected UTF-8 text, got other bytes; save it as UTF-8", path=path
        ) from error
    return parse_limits(text, path)


def parse_limits(text: str, path: Path | None = None) -> Limits:
    """Return the limits of a TOML text.

    ``[limits]`` is for everything, each ``[[for]]`` with `limits` for what its `policy`, `scene`
    and `trace` match (``*`` stands for any text).

    Raises `InputError` if a key, metric or amount is not as it has to be.
    """
    return _Reader(text, path).read()


class _Reader:
    """The text of a limits file, which knows on which line a key stands."""

    def __init__(self, text: str, path: Path | None) -> None:
        self._text, self._path = text, path
        self._from = 0  # tables are read in order, so a key stands after the last one found

    def read(self) -> Limits:
        try:
            document = tomllib.loads(self._text)
        except tomllib.TOMLDecodeError as error:
            found = re.search(r"line (\d+)", str(error))
            line = int(found[1]) if found else None
            raise InputError(f"expected TOML, got {error}", path=self._path, line=line) from error
        self._known(document, ("limits", "for"))
        self._from = self._line_index(r"\[limits\]")
        rules = [Rule(self._limits(document.get("limits", {})))]
        self._from = 0
        scoped = document.get("for", [])
        if not isinstance(scoped, list):
            self._fail("for", "expected [[for]] with two brackets, got one table")
        rules += [self._rule(table) for table in cast("list[Any]", scoped)]
        if not any(rule.limits for rule in rules):
            self._fail("limits", "expected at least one limit, got none; see docs/ci.md")
        return Limits(tuple(rules), self._path)

    def _rule(self, table: Any) -> Rule:
        self._from = self._line_index(r"\[\[for\]\]") + 1
        self._known(table, (*_SCOPE, "limits"))
        scope: list[str] = []
        for name in _SCOPE:
            pattern = table.get(name, "*")
            if not isinstance(pattern, str):
                self._fail(name, f"expected a name of a {name} in quotes, got {pattern}")
            scope.append(pattern)
        return Rule(self._limits(table.get("limits", {})), *scope)

    def _limits(self, table: Any) -> dict[str, tuple[Limit, ...]]:
        if not isinstance(table, dict):
            self._fail("limits", "expected a table of metrics, got another value")
        return {
            metric: self._metric(metric, entry)
            for metric, entry in cast("dict[str, Any]", table).items()
        }

    def _metric(self, metric: str, entry: Any) -> tuple[Limit, ...]:
        try:
            unit = find_metric(metric).unit
        except InputError as error:
            self._fail(metric, error.message)
        if not isinstance(entry, dict):
            self._fail(metric, f"expected {{ max = ... }} or another limit, got {entry}")
        entry = cast("dict[str, Any]", entry)
        kinds: tuple[Kind, ...] = get_args(Kind)
        self._known(entry, (*kinds, "floor"))
        line = None if self._path is None else self._line_of(metric)
        floor = self._amount(metric, unit, "floor", entry["floor"]) if "floor" in entry else None
        limits = [
            Limit(
                metric,
                kind,
                self._amount(metric, unit, kind, entry[kind]),
                floor if kind.startswith("max_") else None,
                line,
            )
            for kind in kinds
            if kind in entry
        ]
        if not limits or (floor is not None and not any(limit.relative for limit in limits)):
            self._fail(metric, f"expected one of {', '.join(kinds)}, got {', '.join(entry)}")
        return tuple(limits)

    def _amount(self, metric: str, unit: str, key: str, value: object) -> Amount:
        amount = parse_amount(value)
        allowed = {"unit", "frames"} if key == "floor" else {"unit", "frames", "share"}
        if key in {"max", "min"}:
            allowed = {"unit", "frames", "budget"}
        if amount is None or amount.measure not in allowed:
            names = {"unit": "a number", "share": '"5%"', "frames": '"1 frame"'}
            known = [names.get(name, '"budget"') for name in sorted(allowed, reverse=True)]
            self._fail(metric, f"{key}: expected {' or '.join(known)}, got {value}")
        if amount.measure in {"frames", "budget"} and unit != "ms":
            self._fail(metric, f"{key}: expected a number, got {value}: {metric} is in {unit}")
        if key not in {"max", "min"} and amount.number < 0.0:
            self._fail(metric, f"{key}: expected an amount >= 0, got {value}")
        return amount

    def _known(self, table: Any, keys: tuple[str, ...]) -> None:
        if not isinstance(table, dict):
            self._fail("", "expected a table, got another value")
        for key in cast("dict[str, Any]", table):
            if key not in keys:
                near = difflib.get_close_matches(key, keys, n=1)
                hint = f"; did you mean {near[0]}?" if near else ""
                self._fail(key, f"expected one of {', '.join(keys)}, got {key}{hint}")

    def _line_index(self, pattern: str) -> int:
        """Return the index of the first line from here on that holds a pattern, or 0."""
        lines = self._text.splitlines()
        found = (i for i in range(self._from, len(lines)) if re.search(pattern, lines[i]))
        return next(found, 0)

    def _line_of(self, key: str) -> int | None:
        index = self._line_index(rf"(?<![\w-]){re.escape(key)}(?![\w-])") if key else 0
        return index + 1 if index or key in self._text.partition("\n")[0] else None

    def _fail(self, key: str, message: str) -> NoReturn:
        raise InputError(message, path=self._path, line=self._line_of(key))
