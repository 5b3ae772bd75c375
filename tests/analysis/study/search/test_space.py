"""The parameters that are searched: their ranges, and points within them."""

from typing import Any

import pytest

from lodbench.analysis.study.search.space import Axis, find_axes, scatter
from lodbench.base.errors import InputError
from lodbench.policies.registry import parse_policy


def axes_of(policy: str, *over: str, knob: str | None = None) -> dict[str, Axis]:
    """Return the axes of a policy by name."""
    return {axis.name: axis for axis in find_axes(parse_policy(policy), over, knob)}


def test_ranges_are_those_that_the_class_declares() -> None:
    """A bounded one is whole, an open one a factor of 8 to either side of the value, within it."""
    found = axes_of("feedback", "rate_limit", "gain", "min_bias", "max_bias")
    assert found["rate_limit"] == Axis("rate_limit", 1.0, 8.8, "log")  # 1.1 / 8 is below 1
    assert found["gain"] == Axis("gain", 0.0625, 4.0, "log")
    assert found["max_bias"] == Axis("max_bias", 8.0, 512.0, "log")
    assert found["min_bias"].low == pytest.approx(0.001)  # (0, 1] is without 0
    assert found["min_bias"].high == 1.0
    assert axes_of("feedback:gain=2", "gain")["gain"] == Axis("gain", 0.25, 16.0, "log")


def test_what_is_no_number_is_chosen_from() -> None:
    """Every value of a word or a switch has an equal part of the axis; so have whole numbers."""
    found = axes_of("funkhouser", "mode", "skip", "max_steps=1:4")
    assert [found["skip"].at(share) for share in (0.0, 0.49, 0.51, 1.0)] == [
        False,
        False,
        True,
        True,
    ]
    assert {found["mode"].at(share / 9) for share in range(10)} == {"greedy", "incremental", "hull"}
    steps = [found["max_steps"].at(share / 400) for share in range(401)]
    assert {steps.count(step) for step in (1, 2, 3)} == {100}
    assert steps.count(4) == 101


def test_a_range_may_be_given() -> None:
    """On a log scale from a factor of 8 on, else on a linear one; the ends are reached."""
    found = axes_of("static-screen", "ratio=0.2:0.4", "first=0.01:1")
    assert (found["ratio"].scale, found["first"].scale) == ("linear", "log")
    assert found["first"].at(0.5) == pytest.approx(0.1)
    assert [found["ratio"].at(share) for share in (0.0, 1.0)] == [0.2, 0.4]


def test_without_a_name_all_with_a_range_are_searched_but_the_knob() -> None:
    """The knob is brought to the budget in every trial, and is no axis."""
    found = axes_of("static-screen", knob="bias")
    assert set(found) == {"first", "ratio", "hysteresis"}


@pytest.mark.parametrize(
    ("over", "message"),
    [
        (["ratoi"], "did you mean ratio?"),
        (["bias"], "expected parameters beside the knob, got bias"),
        (["ratio", "ratio=0.1:0.2"], "expected ratio once"),
        (["ratio=0.5"], "expected ratio=LOW:HIGH, got ratio=0.5"),
        (["ratio=0.5:0.1"], "expected ratio=LOW:HIGH"),
        (["ratio=0.5:nan"], "expected ratio=LOW:HIGH"),
        (["ratio=0.5:2"], "expected ratio in (0, 1), got 2"),
    ],
)
def test_bad_ranges(over: list[str], message: str) -> None:
    """One line says what was expected."""
    with pytest.raises(InputError) as caught:
        find_axes(parse_policy("static-screen"), over, "bias")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("policy", "over", "message"),
    [
        ("lodmanager", ["near_m"], "use --over near_m=LOW:HIGH"),
        ("full", [], "expected a parameter with a declared range, got none"),
        ("funkhouser", ["skip=0:1"], "expected a number to have a range, got skip"),
        ("funkhouser", ["max_steps=1:2.5"], "expected whole numbers for max_steps"),
    ],
)
def test_parameters_without_a_range(policy: str, over: list[str], message: str) -> None:
    """What nobody bounded has to be bounded by the user."""
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        find_axes(parse_policy(policy), over, None)


def test_points_are_spread_and_the_same_for_a_seed() -> None:
    """Of 8 points of a Sobol sequence each eighth of the axis has one; the shipped one is first."""
    spec = parse_policy("static-screen:bias=2")
    axes = find_axes(spec, ["ratio=0.15:0.95"], "bias")
    found = scatter(spec, axes, 8, seed=3)
    ratios: list[Any] = [one.params["ratio"] for one in found[1:]]
    assert sorted(int((ratio - 0.15) / 0.1) for ratio in ratios) == list(range(8))
    assert found[0] is spec
    assert found[1].label == f"static-screen:bias=2,ratio={ratios[0]}"
    assert [one.label for one in scatter(spec, axes, 8, seed=3)] == [one.label for one in found]
    assert scatter(spec, axes, 8, seed=4)[1].label != found[1].label


def test_choices_that_come_to_the_same_are_tried_once() -> None:
    """A switch has two values, one of which is the shipped one, spelt out or not."""
    spec = parse_policy("zach")
    found = scatter(spec, find_axes(spec, ["splitting"], "aim"), 8, seed=0)
    assert [one.label for one in found] == ["zach", "zach:splitting=off"]
