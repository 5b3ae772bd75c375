"""The one parameter by which a policy trades picture for time."""

import inspect
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

from ..base.errors import InputError, PolicyError
from ..base.foreign_text import describe_error, describe_value
from ..base.nearest_names import unknown_name
from .policy_spec import PolicySpec, parameters
from .registry import vary_policy
from .shared.ranges import range_of

Scale = Literal["log", "linear"]
Finer = Literal["higher", "lower"]

_DIGITS = 4  # significant ones, so that labels are short
_ALL_DIGITS = 17  # enough to tell any two floats apart


@dataclass(frozen=True, slots=True)
class Knob:
    """The parameter that trades picture for time, and the range in which it is worth turning.

    A policy says so with an attribute or property `knob`; without one, or with None, it runs as it
    is.  Raises `InputError` if a field is of another kind, or the range is empty.

    Attributes
    ----------
    name : str
        The parameter, a keyword of the policy's class.
    low, high : float
        Ends of the range, in the parameter's own unit.
    scale : {"log", "linear"}
        On which scale equal steps count as equal.
    finer : {"higher", "lower"}
        Which end draws the finer picture, and takes more time.
    """

    name: str
    low: float
    high: float
    scale: Scale = "log"
    finer: Finer = "higher"

    def __post_init__(self) -> None:
        if not (isinstance(self.name, str) and self.name.isidentifier()):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise _refuse("name", "the name of a parameter", self.name)
        for end in ("low", "high"):
            value: Any = getattr(self, end)
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not (number and math.isfinite(value)):
                raise _refuse(end, "a finite number", value)
        for field, kind in (("scale", Scale), ("finer", Finer)):
            choices = get_args(kind)
            if getattr(self, field) not in choices:
                raise _refuse(field, " or ".join(choices), getattr(self, field))
        if not self.low < self.high:
            raise InputError(f"knob: expected low < high, got {self.low:g} and {self.high:g}")
        if self.scale == "log" and self.low <= 0.0:
            raise InputError(
                f"knob: expected low > 0 on a log scale, got {self.low:g}; use scale linear"
            )

    def values(self, count: int) -> tuple[float, ...]:
        """Return `count` values evenly spaced on the scale, coarsest first, both ends included.

        Values between the ends have four significant digits, or as many more as tell them apart.

        Raises `InputError` if fewer than two are asked for.
        """
        if count < 2:
            raise InputError(f"knob: expected two values or more, got {count}")
        low, high = self._along(self.low), self._along(self.high)
        steps = [low + (high - low) * step / (count - 1) for step in range(1, count - 1)]
        inner = [self._back(step) for step in steps]
        low_end, high_end = float(self.low), float(self.high)
        values = (low_end, *inner, high_end)
        for digits in range(_DIGITS, _ALL_DIGITS):
            rounded = (low_end, *(_round(value, digits) for value in inner), high_end)
            if all(a < b for a, b in pairwise(rounded)):
                values = rounded
                break
        return values if self.finer == "higher" else values[::-1]

    def where(self, value: float) -> float:
        """Return how far a value is from the coarse end to the fine one, in [0, 1].

        What is beyond an end is at it.
        """
        value = min(max(value, self.low), self.high)
        low, high = self._along(self.low), self._along(self.high)
        share = (self._along(value) - low) / (high - low)
        return share if self.finer == "higher" else 1.0 - share

    def at(self, share: float) -> float:
        """Return the value that lies so far from the coarse end to the fine one, 0 to 1.

        Between the ends it has four significant digits.
        """
        along = share if self.finer == "higher" else 1.0 - share
        if along in (0.0, 1.0):
            return float(self.high if along else self.low)
        low, high = self._along(self.low), self._along(self.high)
        return _round(self._back(low + along * (high - low)), _DIGITS)

    def _along(self, value: float) -> float:
        return math.log(value) if self.scale == "log" else float(value)

    def _back(self, along: float) -> float:
        return math.exp(along) if self.scale == "log" else along


def knob_of(spec: PolicySpec) -> Knob | None:
    """Return the knob of a policy as it is made, or None if it has none.

    A knob may depend on the parameters, as that of a policy that wraps another one does.

    Raises `InputError`, naming the class, if it is no `Knob`, or the class has no such parameter or
    refuses an end of its range.
    """
    policy = spec.make()
    try:
        knob: object = getattr(policy, "knob", None)
    except (Exception, SystemExit) as error:  # a user's property may raise anything
        said = describe_error(error)
        raise InputError(f"policy class {spec.cls.__name__}: knob: {said}") from error
    if knob is None:
        return None
    return _checked(spec, knob, makes=True)


def declared_knob(spec: PolicySpec) -> Knob | None:
    """Return the knob that a policy's class declares, without making a user's policy.

    What a user's class computes, such as a property, counts as none.

    Raises `InputError` as `knob_of`.
    """
    if spec.cls.__module__.startswith("lodbench."):
        return knob_of(spec)
    knob: object = inspect.getattr_static(spec.cls, "knob", None)
    if knob is None or hasattr(knob, "__get__"):
        return None
    return _checked(spec, knob, makes=False)


def _checked(spec: PolicySpec, knob: object, *, makes: bool) -> Knob:
    """Return a knob that fits the class; `makes` says whether policies are made to find out."""
    where = f"policy class {spec.cls.__name__}: knob"
    if not isinstance(knob, Knob):
        raise InputError(f"{where}: expected a Knob or None, got {describe_value(knob)}")
    known = [parameter.name for parameter in parameters(spec.cls)]
    if knob.name not in known:
        raise InputError(f"{where}: {unknown_name(knob.name, known)}")
    interval = range_of(spec.cls, knob.name)
    for end in (knob.low, knob.high):
        if interval is not None and end not in interval:
            raise InputError(f"{where}: expected {knob.name} in {interval.text}, got {end:g}")
        # An object is what it is; of its class only the parameters that are plain are known.
        if spec.made is None:
            try:
                varied = vary_policy(spec, {knob.name: end})
                if makes:
                    varied.make()
            except (InputError, PolicyError) as error:
                raise InputError(f"{where}: {error}") from error
    return knob


def _refuse(field: str, expected: str, value: object) -> InputError:
    return InputError(f"knob: {field}: expected {expected}, got {describe_value(value)}")


def _round(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")
