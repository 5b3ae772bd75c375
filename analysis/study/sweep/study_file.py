"""A study as a TOML file says it.

Axes stand at the top as a value, a list, or a range; ``[policies.NAME]`` has the parameters of a
policy, and each ``[[exclude]]`` leaves combinations out.  Files are named from the folder of the
TOML file.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn, cast

from ....base.errors import InputError
from ....base.files.strict_toml import TomlDocument, read_toml
from ....base.reader_guard import guarded
from ....policies.policy_spec import PolicySpec
from ....policies.registry import parse_policy
from ....sim.machine.faults import parse_faults
from ....traces.cameras.shared_screen import MOST_PLAYERS
from ..axes.conditions import MACHINE, option_axis
from ..axes.parameters import column_of, param_axis
from ..axes.values import count_range, step_range
from ..inputs import as_eyes, parse_seconds
from ..study import Study
from .file_names import find_things, policy_text_in

_ADVICE = "give a study in UTF-8, see docs/sweeps.md"
_LARGEST_BYTES = 1 << 20
_RANGE = ("from", "to", "step", "count", "log")

_NAMED = ("scenes", "traces", "hardware")
_OPTIONS = (
    *("budget_ms", "fovy_deg", "crossfade_ms", "measurement_delay", "faults"),
    *("bound_every", "memory_bytes", "visible_px", "eyes"),
)
_NAMES = ("display", "pacing")
_COUNTED = ("draws", "seeds")
_SINGLE = ("seconds", "warmup_s", "place")
KEYS = ("policies", *_NAMED, *MACHINE, *_OPTIONS, *_COUNTED, *_SINGLE, "exclude")
"""What the top of a study may have."""


def read_study(path: Path) -> Study:
    """Read a study from a TOML file, and load what it names; it is called by the file's name.

    Raises `InputError` if it is missing, not TOML, or a key or value is not as it has to be; with
    the line.
    """
    with guarded(path, "a study", "see docs/sweeps.md"):
        return _Reader(read_toml(path, _LARGEST_BYTES, _ADVICE), path.parent).read(path.stem)


class _Reader:
    def __init__(self, document: TomlDocument, folder: Path) -> None:
        self._document, self._folder = document, folder

    def read(self, name: str) -> Study:
        content = self._document.table(self._document.content, KEYS, "")
        given: dict[str, Any] = {"name": name}
        for key in (key for key in KEYS if key in content):
            given[key] = self._given(key, content[key])
        given["policies"], given["parameters"] = given.get("policies", (None, {}))
        exclude = given.pop("exclude", [])
        try:
            study = Study(**given, exclude=exclude)
            study.inputs  # noqa: B018 - loads them here, where a mistake is told with its line
        except InputError as error:
            if error.path is not None:
                raise
            self._blame(error, given, exclude)
        return study

    def _given(self, key: str, value: Any) -> Any:
        """Return what a study is given for a key, checked as far as it can be by itself."""
        try:
            if key == "policies":
                return self._policies(value)
            if key == "exclude":
                return self._exclusions(value)
            if key == "traces":
                return self._paths(value)
            if key in _NAMED:
                return find_things(self._texts(value, key), self._folder)
            if key in _COUNTED and isinstance(value, int):
                return value
            if key == "seconds":
                return parse_seconds(value)
            if key in _SINGLE:
                return value
            values = [self._value(key, item) for item in self._values(value, key)]
            if key in _OPTIONS:
                option_axis(key, values)
        except InputError as error:
            self._fail(key, error)
        return values

    def _value(self, key: str, value: Any) -> Any:
        """Return one value of a condition: ``none`` and ``mean`` are what they stand for."""
        if key == "faults":
            return parse_faults("" if value == "none" else str(value))
        # Of pacing, none is one of its kinds.
        if key != "pacing" and value == ("mean" if key == "draws" else "none"):
            return None
        if key not in _NAMES and isinstance(value, str):
            self._document.fail(key, f"{key}: expected a number, got {value!r}; write a number")
        return as_eyes(value) if key == "eyes" else value

    def _values(self, value: Any, where: str) -> list[Any]:
        """Return the values of an axis that is given as one, as a list or as a range."""
        if isinstance(value, list):
            return [self._plain(item, where) for item in cast("list[Any]", value)]
        if isinstance(value, dict):
            return self._range(cast("dict[str, Any]", value), where)
        return [self._plain(value, where)]

    def _plain(self, value: Any, where: str) -> Any:
        if not isinstance(value, (bool, int, float, str)):
            kind = type(value).__name__
            self._document.fail(where, f"expected a value, a list of values or a range, got {kind}")
        return value

    def _range(self, table: dict[str, Any], where: str) -> list[Any]:
        table = self._document.table(table, _RANGE, where)
        for key in ("from", "to"):
            if key not in table:
                self._document.fail(where, f"expected from and to, found no {key}; add it")
        if ("step" in table) == ("count" in table):
            self._document.fail(where, "expected either step or count beside from and to")
        log = table.get("log", False)
        if not isinstance(log, bool) or (log and "step" in table):
            self._document.fail(where, "expected log = true beside count, not step")
        try:
            if "step" in table:
                return step_range(table["from"], table["to"], table["step"])
            return count_range(table["from"], table["to"], table["count"], log=log)
        except InputError as error:
            self._fail(where, error)

    def _texts(self, value: Any, where: str) -> list[str]:
        items = cast("list[Any]", value) if isinstance(value, list) else [value]
        for item in items:
            if not isinstance(item, str):
                self._document.fail(where, f"expected names in quotes, got {item!r}")
        return items

    def _paths(self, value: Any) -> dict[str, str | tuple[str, ...]]:
        """Return traces by what results call them; a list among them is of players of a screen."""
        found: dict[str, str | tuple[str, ...]] = {}
        for item in cast("list[Any]", value) if isinstance(value, list) else [value]:
            paths = find_things(self._texts(item, "traces"), self._folder)
            if isinstance(item, list) and not 1 <= len(paths) <= MOST_PLAYERS:
                self._document.fail(
                    "traces", f"expected 1 to {MOST_PLAYERS} players of a screen, got {len(paths)}"
                )
            shared = {" + ".join(paths): tuple(paths.values())}
            for name, path in (shared if isinstance(item, list) else paths).items():
                if name in found:
                    raise InputError(f"{name}: expected each once, got it twice; name it once")
                found[name] = path
        return found

    def _policies(self, value: Any) -> tuple[dict[str, PolicySpec], dict[str, dict[str, Any]]]:
        """Return the policies by label, and the values of the parameters that vary."""
        if not isinstance(value, dict):
            found: dict[str, PolicySpec] = {}
            for text in self._texts(value, "policies"):
                if text in found:
                    self._document.fail("policies", f"expected each once, got {text} twice")
                found[text] = self._policy(text, "policies")
            return found, {}
        specs: dict[str, PolicySpec] = {}
        varied: dict[str, dict[str, Any]] = {}
        for label, given in cast("dict[str, Any]", value).items():
            where = f"policies.{label}"
            specs[label] = self._policy(label, where)
            if not isinstance(given, dict):
                self._document.fail(where, "expected a table of parameters, {} for none")
            varied[label] = {}
            for name, values in cast("dict[str, Any]", given).items():
                inner = f"{where}.{name}"
                varied[label][name] = self._values(values, inner)
                try:
                    param_axis(specs[label], column_of(name), name, varied[label][name])
                except InputError as error:
                    self._fail(inner, error)
        return specs, varied

    def _policy(self, text: str, where: str) -> PolicySpec:
        try:
            spec = parse_policy(policy_text_in(self._folder, text))
        except InputError as error:
            self._fail(where, error)
        name, _, _ = text.partition("=")
        name = name.rpartition(":")[0] if "=" in text else name
        return replace(spec, label=text, name=name)

    def _exclusions(self, value: Any) -> list[dict[str, Any]]:
        if not isinstance(value, list):
            self._document.fail("exclude", "expected [[exclude]] with two brackets, got one table")
        return [
            {
                axis: self._values(given, f"exclude.{number}.{axis}")
                for axis, given in self._table(table, f"exclude.{number}").items()
            }
            for number, table in enumerate(cast("list[Any]", value))
        ]

    def _table(self, value: Any, where: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            self._document.fail(where, f"expected a table of axes, got {type(value).__name__}")
        return cast("dict[str, Any]", value)

    def _blame(self, error: InputError, given: dict[str, Any], exclude: list[Any]) -> NoReturn:
        """Raise an error about the study as a whole with the line of what is to blame."""
        for number, exclusion in enumerate(exclude):
            try:
                Study(**given, exclude=[exclusion])
            except InputError as alone:
                if alone.message.startswith("exclude: "):
                    self._fail(f"exclude.{number}", alone)
        first = error.message.partition(":")[0].partition(" ")[0]
        named = [
            key
            for key in given
            if first in {key, key.removesuffix("_s")} or key.rstrip("s") == first.rstrip("s")
        ]
        self._fail(named[0] if named else "", error)

    def _fail(self, where: str, error: InputError) -> NoReturn:
        if error.path is not None:
            raise error
        path, line = self._document.path, self._document.line_of(where)
        raise InputError(error.message, path=path, line=line) from error
