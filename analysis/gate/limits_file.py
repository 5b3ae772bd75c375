"""Limits as a TOML file says them."""

from pathlib import Path
from typing import Any, cast, get_args

from ...base.errors import InputError
from ...base.files.strict_toml import TomlDocument, read_toml
from ...base.reader_guard import guarded
from ..metrics.metric_registry import find_metric
from ..verdict.metric_kinds import kind_of
from .amount import Amount, parse_amount
from .limits import Kind, Limit, LimitRules, Population, Rule

ABSOLUTE_LIMITS = """[limits]
work_ms_p99 = { max = "budget", population = "such-paths" }
"""
"""Limits without a file and without a baseline."""
DEFAULT_LIMITS = """[limits]
work_ms_p99 = [
    { max = "budget", population = "such-paths" },
    { max_increase = "2.5%", population = "this-path" },
]
"""
"""Limits without a file.  2.5 % lies midway between no change and the 5 % that has to be found."""

_SCOPE = ("policy", "scene", "trace")
_LARGEST_BYTES = 1 << 20


def choose_limits(path: Path | None, baseline: Path, *, updating: bool = False) -> LimitRules:
    """Return the limits of a file; without one `DEFAULT_LIMITS`, as far as they can be judged.

    Raises
    ------
    InputError
        As `read_limits`; or if a baseline is to be updated that no limit needs.
    """
    if path is None:
        judged = DEFAULT_LIMITS if updating or baseline.exists() else ABSOLUTE_LIMITS
        return parse_limits(judged)
    limits = read_limits(path)
    if updating and not limits.relative:
        raise InputError(
            "expected a limit relative to the baseline, got none; add max_increase", path=path
        )
    return limits


def read_limits(path: Path) -> LimitRules:
    """Read a file of limits.

    ``[limits]`` is for everything, each ``[[for]]`` with `limits` for what its `policy`, `scene`
    and `trace` match (``*`` stands for any text).  Every limit names its population; ``population``
    above all tables is that of those that do not.

    Raises `InputError` if it is missing, not TOML, or a key, metric or amount is not as it has to
    be, or an extreme is limited against a baseline; with the line.
    """
    with guarded(path, "a file of limits", "see docs/ci.md"):
        document = read_toml(path, _LARGEST_BYTES, "give limits in UTF-8, see docs/ci.md")
        return _Reader(document).read()


def parse_limits(text: str) -> LimitRules:
    """Return the limits of a TOML text; raises InputError as `read_limits`."""
    return _Reader(TomlDocument(text)).read()


class _Reader:
    def __init__(self, document: TomlDocument) -> None:
        self._document = document
        self._population: Population | None = None  # where a limit does not name one

    def read(self) -> LimitRules:
        document = self._document
        content = document.table(document.content, ("population", "limits", "for"), "")
        self._population = self._population_of(content.get("population"), "population")
        rules = [Rule(self._limits(content.get("limits", {}), "limits"))]
        scoped = content.get("for", [])
        if not isinstance(scoped, list):
            document.fail("for", "expected [[for]] with two brackets, got one table")
        rules += [
            self._rule(table, f"for.{number}")
            for number, table in enumerate(cast("list[Any]", scoped))
        ]
        if not any(rule.limits for rule in rules):
            document.fail("limits", "expected at least one limit, got none; see docs/ci.md")
        return LimitRules(tuple(rules), document.path)

    def _rule(self, table: Any, where: str) -> Rule:
        table = self._document.table(table, (*_SCOPE, "limits"), where)
        scope: list[str] = []
        for name in _SCOPE:
            pattern = table.get(name, "*")
            if not isinstance(pattern, str):
                message = f"expected a name of a {name} in quotes, got {pattern}"
                self._document.fail(f"{where}.{name}", message)
            scope.append(pattern)
        return Rule(self._limits(table.get("limits", {}), f"{where}.limits"), *scope)

    def _limits(self, table: Any, where: str) -> dict[str, tuple[Limit, ...]]:
        if not isinstance(table, dict):
            self._document.fail(where, "expected a table of metrics, got another value")
        return {
            metric: self._several(metric, entry, f"{where}.{metric}")
            for metric, entry in cast("dict[str, Any]", table).items()
        }

    def _several(self, name: str, entry: Any, where: str) -> tuple[Limit, ...]:
        """Return the limits of a metric: of one table, or of several for several populations."""
        tables: list[Any] = [entry]
        if isinstance(entry, list) and entry:
            tables = cast("list[Any]", entry)
        return tuple(limit for table in tables for limit in self._metric(name, table, where))

    def _metric(self, name: str, entry: Any, where: str) -> tuple[Limit, ...]:
        document = self._document
        try:
            metric = find_metric(name)
        except InputError as error:
            document.fail(where, error.message)
        if not isinstance(entry, dict):
            document.fail(where, f"expected {{ max = ... }} or another limit, got {entry}")
        kinds: tuple[Kind, ...] = get_args(Kind)
        entry = dict(document.table(entry, (*kinds, "floor", "population"), where))
        population = self._population_of(entry.pop("population", None), where) or self._population
        amounts = {key: self._amount(metric.unit, key, entry[key], where) for key in entry}
        found: list[Kind] = [kind for kind in kinds if kind in amounts]
        floor = amounts.get("floor")
        relative = [kind for kind in found if kind.startswith("max_")]
        if not found or (floor is not None and not relative):
            document.fail(where, f"expected one of {', '.join(kinds)}, got {', '.join(entry)}")
        if relative and kind_of(metric) == "extreme":
            document.fail(
                where,
                f"{relative[0]}: expected a metric that is a mean or a quantile, got an extreme, "
                "of which one run says nothing about the next; limit it by max",
            )
        if population is None:
            document.fail(
                where,
                'expected population = "this-path", for these very paths, or "such-paths", for '
                "others of their kind, got none; name one",
            )
        line = None if document.path is None else document.line_of(where)
        return tuple(
            Limit(name, kind, amounts[kind], population, floor if kind in relative else None, line)
            for kind in found
        )

    def _population_of(self, value: object, where: str) -> Population | None:
        populations: tuple[Population, ...] = get_args(Population)
        if value is not None and value not in populations:
            known = " or ".join(f'"{name}"' for name in populations)
            self._document.fail(where, f"population: expected {known}, got {value}")
        return next((name for name in populations if name == value), None)

    def _amount(self, unit: str, key: str, value: object, where: str) -> Amount:
        amount = parse_amount(value)
        allowed = {"unit", "frames"} if key == "floor" else {"unit", "frames", "share"}
        if key in {"max", "min"}:
            allowed = {"unit", "frames", "budget"}
        if amount is None or amount.measure not in allowed:
            names = {"unit": "a number", "share": '"5%"', "frames": '"1 frame"'}
            known = [names.get(name, '"budget"') for name in sorted(allowed, reverse=True)]
            self._document.fail(where, f"{key}: expected {' or '.join(known)}, got {value}")
        if amount.measure in {"frames", "budget"} and unit != "ms":
            message = f"{key}: expected a number, got {value}: the metric is in {unit}"
            self._document.fail(where, message)
        if key not in {"max", "min"} and amount.number < 0.0:
            self._document.fail(where, f"{key}: expected an amount >= 0, got {value}")
        return amount
