"""Ranges of parameters, declared beside them and checked in one place.

A policy writes ``gain: NotNegative = 0.5`` and calls `check_parameters` in its `reset`.  What a
command line gives is checked before any policy is made (`PolicySpec.check_parameters`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeAlias, get_args, get_origin, get_type_hints

from ...base.errors import InputError


@dataclass(frozen=True, slots=True)
class Interval:
    """Numbers between two ends, written as in mathematics: ``(0, 1]`` is without 0 and with 1."""

    text: str

    def __contains__(self, value: float) -> bool:
        """Return whether a number lies in the interval; NaN lies in none."""
        low, high = map(float, self.text[1:-1].split(","))
        from_low = low <= value if self.text[0] == "[" else low < value
        return from_low and (value <= high if self.text[-1] == "]" else value < high)


Share: TypeAlias = Annotated[float, Interval("(0, 1]")]
UpToOne: TypeAlias = Annotated[float, Interval("[0, 1]")]
BelowOne: TypeAlias = Annotated[float, Interval("[0, 1)")]
Aim: TypeAlias = Annotated[float, Interval("(0, 1.5]")]
"""Share of the budget that a predicted time may take; above 1 where predictions are too high."""
Fraction: TypeAlias = Annotated[float, Interval("(0, 1)")]
Positive: TypeAlias = Annotated[float, Interval("(0, inf]")]
Finite: TypeAlias = Annotated[float, Interval("(0, inf)")]
NotNegative: TypeAlias = Annotated[float, Interval("[0, inf]")]
AtLeastOne: TypeAlias = Annotated[float, Interval("[1, inf]")]
Count: TypeAlias = Annotated[int, Interval("[0, inf]")]
PositiveInt: TypeAlias = Annotated[int, Interval("[1, inf]")]


def check_parameters(policy: Any, name: str) -> None:
    """Raise `InputError` if a parameter of a policy is refused (see `check_values`)."""
    values = {parameter.name: getattr(policy, parameter.name) for parameter in fields(policy)}
    check_values(policy.__class__, values, name)


def check_values(cls: type[Any], values: Mapping[str, Any], name: str) -> None:
    """Raise `InputError` if a value lies outside its range, or those of the class's `rising` fall.

    A range is an `Interval` in the parameter's annotation, or the values of a `Literal`; None is
    outside of all ranges where the annotation does not allow for it.  A class names parameters that
    must not fall in `rising`, a tuple.
    """
    hints = get_type_hints(cls, include_extras=True)
    for parameter, value in values.items():
        hint = hints[parameter]
        kinds = get_args(hint)
        if value is None and type(None) in kinds:
            continue
        if get_origin(hint) is Literal and value not in kinds:
            choices = ", ".join(kinds)
            raise InputError(f"{name}: expected {parameter} one of {choices}, got {value}")
        interval = _interval(hint)
        if interval is not None and (value is None or value not in interval):
            raise InputError(f"{name}: expected {parameter} in {interval.text}, got {value}")
    rising: tuple[str, ...] = getattr(cls, "rising", ())
    ordered = [values[parameter] for parameter in rising if parameter in values]
    if any(low > high for low, high in pairwise(ordered)):
        got = ", ".join(f"{value:g}" for value in ordered)
        raise InputError(f"{name}: expected {' <= '.join(rising)}, got {got}")


def range_of(cls: type[Any], parameter: str) -> Interval | None:
    """Return the range that a class declares for a parameter, or None if it declares none."""
    return _interval(get_type_hints(cls, include_extras=True).get(parameter))


def _interval(hint: Any) -> Interval | None:
    for kind in (hint, *get_args(hint)):
        for interval in getattr(kind, "__metadata__", ()):
            if isinstance(interval, Interval):
                return interval
    return None
