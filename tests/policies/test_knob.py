"""Knobs by hand: their values, middles and places, and what is wrong with a user's."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.hoppe import Hoppe
from lodbench.policies.knob import Knob, declared_knob, knob_of
from lodbench.policies.registry import parse_policy, spec_of
from lodbench.policies.shared.ranges import Share
from lodbench.policies.thresholds.static_screen import StaticScreen

ENDS = st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)).filter(lambda ends: ends[0] < ends[1])


def test_values_are_evenly_spaced_on_the_scale() -> None:
    """Doublings on a log scale, equal steps on a linear one; both ends as they are."""
    assert Knob("x", 1, 16).values(5) == (1.0, 2.0, 4.0, 8.0, 16.0)
    assert Knob("x", -1.0, 1.0, scale="linear").values(5) == (-1.0, -0.5, 0.0, 0.5, 1.0)
    assert Knob("x", 0.123456, 12.3456).values(2) == (0.123456, 12.3456)


def test_at_is_where_turned_round() -> None:
    """Ends are what they are, the middle is that of the scale, and tolerances go down."""
    assert [Knob("x", 0.1, 10.0).at(share) for share in (0.0, 0.5, 1.0)] == [0.1, 1.0, 10.0]
    falling = Knob("x", 1.0, 16.0, finer="lower")
    assert [falling.at(share) for share in (0.0, 0.25, 1.0)] == [16.0, 8.0, 1.0]
    assert falling.where(falling.at(0.3)) == pytest.approx(0.3, abs=1e-3)


def test_values_go_from_coarse_to_fine() -> None:
    """A tolerance begins at its highest value."""
    assert Knob("x", 1.0, 4.0, finer="lower").values(3) == (4.0, 2.0, 1.0)


def test_values_have_four_digits_where_those_tell_them_apart() -> None:
    """Cube roots of 10 are rounded; in a range of a hundred-thousandth more digits are kept."""
    assert Knob("x", 1.0, 10.0).values(4) == (1.0, 2.154, 4.642, 10.0)
    assert Knob("x", 1.0, 1.00003, scale="linear").values(4) == (1.0, 1.00001, 1.00002, 1.00003)


@given(ends=ENDS, count=st.integers(2, 30), scale=st.sampled_from(["log", "linear"]))
def test_values_rise_within_the_range(ends: tuple[float, float], count: int, scale: Any) -> None:
    """In any range that has as many numbers, however narrow."""
    low, high = ends
    if high < low * (1.0 + 1e-12):
        return
    values = Knob("x", low, high, scale).values(count)
    assert (values[0], values[-1], len(values)) == (low, high, count)
    assert all(a < b for a, b in pairwise(values))


def test_where_is_the_share_of_the_way_to_the_fine_end() -> None:
    """By hand on both scales and in both directions; what is beyond an end is at it."""
    assert Knob("x", 1.0, 16.0).where(2.0) == pytest.approx(0.25)
    assert Knob("x", 1.0, 16.0, finer="lower").where(2.0) == pytest.approx(0.75)
    assert Knob("x", 1.0, 5.0, scale="linear").where(2.0) == pytest.approx(0.25)
    assert Knob("x", 1.0, 16.0, finer="lower").where(99.0) == 0.0
    assert Knob("x", 1.0, 16.0).where(99.0) == 1.0


@pytest.mark.parametrize("finer", ["higher", "lower"])
@pytest.mark.parametrize("scale", ["log", "linear"])
def test_values_are_where_they_were_asked_for(scale: Any, finer: Any) -> None:
    """The inverse of `values`, but for its rounding to four digits."""
    knob = Knob("x", 0.3, 70.0, scale, finer)
    assert [knob.where(value) for value in knob.values(6)] == pytest.approx(
        [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], abs=2e-4
    )


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"name": 3}, "knob: name: expected the name of a parameter, got 3"),
        ({"name": "two words"}, "knob: name: expected the name of a parameter"),
        ({"low": "1"}, "knob: low: expected a finite number, got"),
        ({"low": True}, "knob: low: expected a finite number, got True"),
        ({"high": math.inf}, "knob: high: expected a finite number, got inf"),
        ({"low": 3.0}, "knob: expected low < high, got 3 and 2"),
        ({"low": 2.0}, "knob: expected low < high, got 2 and 2"),
        ({"low": 0.0}, "knob: expected low > 0 on a log scale, got 0; use scale linear"),
        ({"scale": "square"}, "knob: scale: expected log or linear, got"),
        ({"finer": "more"}, "knob: finer: expected higher or lower, got"),
    ],
)
def test_a_wrong_field_is_refused_in_a_line(wrong: dict[str, Any], message: str) -> None:
    """Each field of another kind, and an empty range."""
    fields: dict[str, Any] = {"name": "x", "low": 1.0, "high": 2.0, **wrong}
    with pytest.raises(InputError) as refused:
        Knob(**fields)
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_fewer_than_two_values_are_refused() -> None:
    """One value has no coarse and fine end."""
    with pytest.raises(InputError, match="expected two values or more, got 1"):
        Knob("x", 1.0, 2.0).values(1)


@dataclass
class Mine(Full):
    """A policy of a user's, to which the tests give a knob."""

    share: Share = 0.5
    count: int = 3
    knob: ClassVar[Any] = Knob("share", 0.1, 1.0)


class Refusing(Mine):
    """A policy that refuses what its knob promises."""

    def __init__(self, share: float = 0.5) -> None:
        if share > 0.9:
            raise ValueError("too much")
        self.share = share


def test_a_users_class_and_object_have_their_knobs() -> None:
    """By class, by object, by name with parameters; and none where nothing is said."""
    assert knob_of(spec_of(Mine)) == knob_of(spec_of(Mine(0.7))) == Mine.knob
    assert knob_of(parse_policy("static-screen:first=0.5")) == StaticScreen.knob
    assert knob_of(spec_of(Full)) is None


def test_a_knob_may_depend_on_parameters() -> None:
    """`hoppe` regulates triangles where it is given a number of them."""
    assert getattr(knob_of(parse_policy("hoppe")), "name", "") == "target"
    assert getattr(knob_of(parse_policy("hoppe:triangles=2e4")), "name", "") == "triangles"
    assert getattr(knob_of(spec_of(Hoppe(triangles=2e4))), "name", "") == "triangles"


@pytest.mark.parametrize(
    ("knob", "message"),
    [
        ("share", "expected a Knob or None, got share"),
        (Knob("shar", 0.1, 1.0), "expected .*, got shar; did you mean share"),
        (Knob("share", 0.1, 1.2), r"expected share in \(0, 1\], got 1\.2"),
        (Knob("count", 1, 2.5), "count: .*, got 2.5"),
    ],
)
def test_a_wrong_knob_of_a_users_class_is_a_line_that_names_it(
    knob: object, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No knob, no such parameter, an end outside its range, an end of another type."""
    monkeypatch.setattr(Mine, "knob", knob)
    with pytest.raises(InputError, match=rf"^policy class Mine: knob: .*{message}") as refused:
        knob_of(spec_of(Mine))
    assert "\n" not in str(refused.value)


class Raising(Mine):
    """A policy whose knob is a property that fails."""

    @property
    def knob(self) -> Knob:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Divide by zero."""
        return Knob("share", 0.1, 1 / (self.count - 3))


def test_a_property_that_fails_is_named() -> None:
    """Whatever a user's code raises is one line with the class."""
    with pytest.raises(InputError, match=r"^policy class Raising: knob: .*ZeroDivisionError"):
        knob_of(spec_of(Raising))


def test_a_class_that_refuses_an_end_of_its_range_is_named() -> None:
    """The range is tried, not believed."""
    with pytest.raises(InputError, match=r"^policy class Refusing: knob: .*too much"):
        knob_of(spec_of(Refusing))


class Hostile(StaticScreen):
    """A user's policy that must not be made outside of a worker."""

    def __post_init__(self) -> None:
        """Fail whoever makes it."""
        raise AssertionError("made")


class Computed(StaticScreen):
    """A user's policy whose knob is not there to be read."""

    @property
    def knob(self) -> Knob:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Fail whoever asks."""
        raise AssertionError("asked")


def test_a_knob_is_read_without_running_what_is_the_users() -> None:
    """The class is not made; what it would compute is none; ours is as `knob_of` has it."""
    assert declared_knob(spec_of(Hostile)) == StaticScreen.knob
    assert declared_knob(spec_of(Computed)) is None
    assert declared_knob(parse_policy("hoppe")) == knob_of(parse_policy("hoppe"))
