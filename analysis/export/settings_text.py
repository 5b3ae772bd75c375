"""Settings of an engine as lines for a terminal."""

from collections.abc import Iterator

from ...base.foreign_text import one_line
from .engine_settings import EngineSettings, TypeSettings, Value

_MOST_TYPES = 12
_LONGEST = 60


def settings_text(settings: EngineSettings) -> str:
    """Return a heading, what is set for all, what on each type's levels, and what differs."""
    where = "" if settings.scene is None else f" in {one_line(settings.scene, _LONGEST)}"
    lines = [f"{one_line(settings.policy, 2 * _LONGEST)}{where}, as settings of {settings.engine}"]
    lines += [f"  {name} = {_value(value)}" for name, value in settings.project.items()]
    for kind in settings.types[:_MOST_TYPES]:
        lines += _type_lines(kind)
    more = len(settings.types) - _MOST_TYPES
    if more > 0:
        lines.append(f"{more} more types: --json or --out has all")
    lines += [f"differs: {sentence}" for sentence in settings.differs]
    return "\n".join(lines)


def _type_lines(kind: TypeSettings) -> Iterator[str]:
    beside = "".join(f", {name} {_value(value)}" for name, value in kind.settings.items())
    yield f"{one_line(kind.name, _LONGEST)}, radius {kind.radius_m:.4g} m{beside}"
    for name in kind.levels[0]:
        yield f"  {name}: {', '.join(_value(level[name]) for level in kind.levels)}"


def _value(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:.6g}"
