"""The parameters that are searched, and scattered points in their ranges."""

import types
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, exp, isfinite, log, log2
from typing import Any, Literal, TypeAlias, Union, get_args, get_origin

from ....base.errors import InputError
from ....base.nearest_names import unknown_name
from ....policies.policy_spec import Parameter, PolicySpec, parameters
from ....policies.registry import vary_policy
from ....policies.shared.ranges import range_of

_REACH = 8.0  # times and parts of the shipped value, where a range has no end of its own
_DIGITS = 4  # significant ones, so that the line to paste is short

Value: TypeAlias = bool | int | float | str


@dataclass(frozen=True, slots=True)
class Axis:
    """One parameter and what is tried of it.

    Attributes
    ----------
    name : str
    low, high : float or None
        Ends of the range of a number, in the parameter's own unit.
    scale : "log", "linear" or "choice"
        On which scale equal steps count as equal.
    whole : bool
        Whether only whole numbers will do.
    choices : tuple
        What a parameter that is no number may be.
    """

    name: str
    low: float | None = None
    high: float | None = None
    scale: Literal["log", "linear", "choice"] = "choice"
    whole: bool = False
    choices: tuple[bool | str, ...] = ()

    def at(self, share: float) -> Value:
        """Return the value at a share of the way from the low end to the high one."""
        if self.low is None or self.high is None:
            return self.choices[min(int(share * len(self.choices)), len(self.choices) - 1)]
        if self.whole:  # each number has a stretch of its own, of equal length
            return int(self.low + min(share, 1.0 - 1e-9) * (self.high - self.low + 1.0))
        if self.scale == "log":
            value = exp(log(self.low) + share * (log(self.high) - log(self.low)))
        else:
            value = self.low + share * (self.high - self.low)
        return min(max(float(f"{value:.{_DIGITS}g}"), self.low), self.high)


def find_axes(spec: PolicySpec, over: Sequence[str], knob: str | None) -> tuple[Axis, ...]:
    """Return the axes that ``name`` and ``name=low:high`` ask for, or all that a class declares.

    A range is the one that the class declares for the parameter; where it has no end, a factor of 8
    beyond the value that the policy has.  None is asked for: every parameter with such a range.

    Raises `InputError` if a name is unknown, is the knob, is given twice, or has no range.

    Parameters
    ----------
    knob
        Name of the policy's knob, which is brought to the budget in every trial.
    """
    known = {parameter.name: parameter for parameter in parameters(spec.cls)}
    if not over:
        free = [one for name, one in known.items() if name != knob]
        found = [axis for one in free if (axis := _declared(spec, one)) is not None]
        if not found:
            raise InputError(
                f"tune {spec.name}: expected a parameter with a declared range, got none; "
                "use --over NAME=LOW:HIGH"
            )
        return tuple(found)
    axes: dict[str, Axis] = {}
    for text in over:
        name, equals, ends = text.partition("=")
        name = name.strip().replace("-", "_")
        if name not in known:
            raise InputError(f"tune {spec.name}: {unknown_name(name, sorted(known))}")
        if name == knob:
            raise InputError(
                f"tune {spec.name}: expected parameters beside the knob, got {name}, which every "
                "trial brings to the budget; leave it out"
            )
        if name in axes:
            raise InputError(f"tune {spec.name}: expected {name} once, got it twice; name it once")
        axis = _between(spec, known[name], ends) if equals else _declared(spec, known[name])
        if axis is None:
            raise InputError(
                f"tune {spec.name}: expected a range of {name}, got none, and its class declares "
                f"none that ends; use --over {name}=LOW:HIGH"
            )
        axes[name] = axis
    return tuple(axes.values())


def scatter(spec: PolicySpec, axes: Sequence[Axis], count: int, seed: int) -> list[PolicySpec]:
    """Return the policy as it is, then up to `count` others, each labelled by what it differs in.

    Points are a scrambled Sobol sequence; those that come to the same values are kept once.

    Source: Owen, Journal of Complexity 14 (1998).

    Raises `InputError` if the class has no such parameters.
    """
    from scipy.stats import qmc

    sobol = qmc.Sobol(len(axes), rng=seed)
    points: list[list[float]] = sobol.random_base2(ceil(log2(max(count, 1))))[:count].tolist()
    defaults = {parameter.name: parameter.default for parameter in parameters(spec.cls)}
    found, seen = [spec], [defaults | spec.params]
    for point in points:
        values = {axis.name: axis.at(share) for axis, share in zip(axes, point, strict=True)}
        varied = vary_policy(spec, values)
        if (whole := defaults | varied.params) not in seen:
            found.append(varied)
            seen.append(whole)
    return found


def _declared(spec: PolicySpec, parameter: Parameter) -> Axis | None:
    """Return the axis that a class's annotation makes, None where it sets no bound."""
    choices = _choices(parameter.kind)
    if choices:
        return Axis(parameter.name, choices=choices)
    interval = range_of(spec.cls, parameter.name)
    if interval is None:
        return None
    whole = float not in _kinds(parameter.kind)
    low, high = map(float, interval.text[1:-1].split(","))
    if isfinite(high):
        # What an open end leaves out is a thousandth of the range away at least.
        step = 1.0 if whole else (high - low) * 1e-3
        low += 0.0 if interval.text[0] == "[" else step
        high -= 0.0 if interval.text[-1] == "]" else step
        return Axis(parameter.name, low, high, "linear", whole)
    value = spec.params.get(parameter.name, parameter.default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 1e300:
        return None
    low = max(value / _REACH, low)
    low, high = (float(ceil(low)), value * _REACH) if whole else (low, value * _REACH)
    return Axis(parameter.name, low, high, "linear" if whole else "log", whole)


def _between(spec: PolicySpec, parameter: Parameter, ends: str) -> Axis:
    """Return the axis from ``low:high``: on a log scale where its ends are a factor of 8 apart."""
    name = parameter.name
    low_text, colon, high_text = ends.partition(":")
    try:
        low, high = float(low_text), float(high_text if colon else "nan")
    except ValueError:
        low = high = float("nan")
    if not (isfinite(low) and isfinite(high) and low < high):
        raise InputError(f"tune {spec.name}: expected {name}=LOW:HIGH, got {name}={ends}")
    kinds = _kinds(parameter.kind)
    if not {int, float} & set(kinds):
        raise InputError(f"tune {spec.name}: expected a number to have a range, got {name}")
    interval = range_of(spec.cls, name)
    for end in (low, high):
        if interval is not None and end not in interval:
            raise InputError(
                f"tune {spec.name}: expected {name} in {interval.text}, got {end:g}; narrow it"
            )
    whole = float not in kinds
    if whole and not (low.is_integer() and high.is_integer()):
        raise InputError(f"tune {spec.name}: expected whole numbers for {name}, got {ends}")
    wide = low > 0.0 and high / low >= _REACH and not whole
    return Axis(name, low, high, "log" if wide else "linear", whole)


def _choices(kind: Any) -> tuple[bool | str, ...]:
    """Return what a parameter of a type may be that is no number."""
    if kind is bool:
        return (False, True)
    return get_args(kind) if get_origin(kind) is Literal else ()


def _kinds(kind: Any) -> tuple[Any, ...]:
    """Return the types that a parameter may have, one or those of a union."""
    return get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)
