"""Over which speeds and refresh rates the first rank stands, on curves worked by hand."""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.verdict.curve import Curve
from lodbench.analysis.verdict.robustness import robustness

KNOB = np.geomspace(1.0, 64.0, 7)  # work, from coarse to fine
PATHS = np.exp([-0.02, -0.01, 0.0, 0.0, 0.01, 0.02])


def curve(error_at_1_ms: float, power: float, work: np.ndarray = KNOB) -> Curve:
    """Return a policy whose error falls with a power of its work, without pops."""
    p99_ms = work[:, None] * PATHS
    error_px = error_at_1_ms / work[:, None] ** power * PATHS
    nothing = np.zeros_like(p99_ms)
    return Curve(work, p99_ms, 0.5 * p99_ms, error_px, nothing, nothing)


def test_always_the_finer_picture_always_stands() -> None:
    """Half the error at every work leads on every machine and at every refresh rate."""
    found = robustness({"a": curve(200.0, 1.0), "b": curve(100.0, 1.0)}, 16.0)
    assert found.first == ("b",)
    assert (found.speed_low, found.speed_high) == (0.5, 2.0)
    assert found.at_refresh == {30.0: ("b",), 60.0: ("b",), 90.0: ("b",), 120.0: ("b",)}
    assert found.misses == {30.0: (), 60.0: (), 90.0: (), 120.0: ()}


def test_curves_that_cross() -> None:
    """Errors 400 / w and 1600 / w^1.5 cross at work 16, where both are 25: from there on b leads.

    Far below 16 ms a leads at every speed that is slower, far above b.
    """
    curves = {"a": curve(400.0, 1.0), "b": curve(1600.0, 1.5)}
    for budget_ms, first in ((9.0, "a"), (32.0, "b")):
        assert robustness(curves, budget_ms).first == (first,)
    found = robustness(curves, 9.0)
    # b is a tenth finer, and a no longer its equal, from a budget of 16 · 1.1² = 19.4 ms on, a
    # little more for what both stay below it: beyond twice the speed.  From 12 ms it is just there.
    assert (found.speed_low, found.speed_high) == (0.5, 2.0)
    later = robustness(curves, 12.0)
    assert later.first == ("a",)
    assert later.speed_high is not None
    assert later.speed_high * 12.0 == pytest.approx(16 * 1.21, rel=0.1)
    there = found.at_refresh
    assert (there[30.0][0], there[90.0], there[120.0]) == ("b", ("a",), ("a",))


def test_who_cannot_reach_a_budget_is_named() -> None:
    """A policy whose coarsest takes 10 ms misses 120 Hz, and leads where it keeps."""
    heavy = curve(1.0, 1.0, np.geomspace(10.0, 64.0, 5))
    found = robustness({"heavy": heavy, "light": curve(400.0, 1.0)}, 16.0)
    assert found.first == ("heavy",)
    assert found.misses == {30.0: (), 60.0: (), 90.0: (), 120.0: ("heavy",)}
    assert found.at_refresh[120.0] == ("light",)
    assert found.speed_low is not None
    # It keeps down to a budget of a little over 10 ms.
    assert 10.0 / 16.0 < found.speed_low < 12.0 / 16.0
    assert found.speed_high == 2.0


def test_a_cost_that_only_one_pays_for_decides() -> None:
    """Half of the error at a fifth more work is still first, at five times it misses the budget."""
    finer, other = curve(100.0, 1.0), curve(200.0, 1.0)

    def costing(factor: float) -> dict[str, Curve]:
        paid = replace(finer, added_ms={"more": factor * finer.p99_ms})
        return {"finer": paid, "other": replace(other, added_ms={"more": other.p99_ms})}

    little, much = robustness(costing(1.2), 4.0), robustness(costing(5.0), 4.0)
    assert little.first == much.first == ("finer",)
    assert (little.with_costs, little.misses_with) == ({"more": ("finer",)}, {"more": ()})
    assert (much.with_costs, much.misses_with) == ({"more": ("other",)}, {"more": ("finer",)})


def test_a_cost_that_not_all_know_is_not_tried() -> None:
    """Curves of logs that do not count it say nothing of it."""
    known = replace(curve(100.0, 1.0), added_ms={"more": curve(100.0, 1.0).p99_ms})
    assert robustness({"a": known, "b": curve(200.0, 1.0)}, 4.0).with_costs == {}


def test_nobody_keeps() -> None:
    """Where nobody keeps the budget there is no first rank that could stand."""
    found = robustness({"a": curve(1.0, 1.0)}, 0.5)
    assert (found.first, found.speed_low, found.speed_high) == ((), None, None)


def test_points_between_replays_are_used() -> None:
    """Two replays of a power law tell as much as seven: the point lies between them."""
    sparse, dense = curve(400.0, 1.0, KNOB[[0, -1]]), curve(400.0, 1.0)
    assert set(robustness({"sparse": sparse, "dense": dense}, 16.0).first) == {"sparse", "dense"}
    assert robustness({"sparse": sparse, "much worse": curve(1200.0, 1.0)}, 16.0).first == (
        "sparse",
    )


def test_a_policy_without_a_knob() -> None:
    """One value of the knob: it keeps the budget as it is, or it does not."""
    fixed = curve(100.0, 1.0, np.array([12.0]))
    found = robustness({"fixed": fixed, "a": curve(400.0, 1.0)}, 16.0)
    assert found.first == ("fixed",)
    assert found.misses[120.0] == ("fixed",)


def test_one_path() -> None:
    """On a single path, who keeps it keeps."""
    one = curve(100.0, 1.0)
    p99_ms, work_ms, error_px = (of[:, :1] for of in (one.p99_ms, one.work_ms, one.error_px))
    one = Curve(KNOB, p99_ms, work_ms, error_px, one.lag_ms[:, :1], one.lag_ms[:, :1])
    assert robustness({"a": one}, 16.0).first == ("a",)
