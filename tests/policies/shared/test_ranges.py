"""Ranges declared beside parameters."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import pytest

from lodbench.base.errors import InputError
from lodbench.policies.shared.ranges import (
    BelowOne,
    Fraction,
    Interval,
    NotNegative,
    Positive,
    Share,
    check_parameters,
)


@dataclass
class Knobs:
    """A parameter of each kind."""

    share: Share = 1.0
    below: BelowOne = 0.0
    fraction: Fraction = 0.5
    limit: Positive | None = None
    gain: NotNegative = math.inf
    mode: Literal["fast", "exact"] = "fast"
    free: float = 2.0

    rising: ClassVar[tuple[str, ...]] = ("below", "fraction")


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("(0, 1]", (1e-300, 1.0), (0.0, -0.1, 1.1, math.nan)),
        ("[0, 1)", (0.0, 0.999), (-1e-300, 1.0)),
        ("[0, inf]", (0, 7, math.inf), (-1, -math.inf)),
        ("(0, inf)", (1,), (0, math.inf)),
    ],
)
def test_intervals_have_their_ends_as_written(
    text: str, inside: tuple[float, ...], outside: tuple[float, ...]
) -> None:
    """A bracket takes the end in, a parenthesis leaves it out; NaN is nowhere."""
    assert all(value in Interval(text) for value in inside)
    assert not any(value in Interval(text) for value in outside)


def test_defaults_and_none_where_it_is_allowed_pass() -> None:
    """Nothing is refused that the annotations allow."""
    check_parameters(Knobs(), "knobs")
    check_parameters(Knobs(limit=3.0, free=math.nan), "knobs")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"share": 0.0}, r"knobs: expected share in \(0, 1\], got 0.0"),
        ({"limit": -1.0}, r"knobs: expected limit in \(0, inf\], got -1.0"),
        ({"gain": math.nan}, r"knobs: expected gain in \[0, inf\], got nan"),
        ({"mode": "slow"}, "knobs: expected mode one of fast, exact, got slow"),
        ({"below": 0.7}, "knobs: expected below <= fraction, got 0.7, 0.5"),
    ],
)
def test_the_parameter_its_range_and_its_value_are_named(
    wrong: dict[str, Any], message: str
) -> None:
    """One shape of message for every range, choice and order."""
    with pytest.raises(InputError, match=message):
        check_parameters(Knobs(**wrong), "knobs")
