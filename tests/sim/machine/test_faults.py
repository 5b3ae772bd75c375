"""Faulty timers: what each fault reports, and impossible shares."""

import math

import pytest

from lodbench.base.errors import InputError
from lodbench.sim.machine.faults import Faults

TRUTH, BEFORE = (2.0, 9.0, 9.0), (1.0, 5.0, 5.0)


@pytest.mark.parametrize(
    ("dice", "expected"),
    [
        (0.0, [math.nan] * 3),
        (0.09, [math.nan] * 3),
        (0.1, [0.0] * 3),
        (0.29, [0.0] * 3),
        (0.31, [1.0, 5.0, 5.0]),
        (0.59, [1.0, 5.0, 5.0]),
        (0.61, [2.0, 8.0, 8.0]),
        (0.99, [2.0, 8.0, 8.0]),
    ],
)
def test_one_die_decides_which_fault_strikes(dice: float, expected: list[float]) -> None:
    """With shares of 10, 20 and 30 % a report is missing, zero, stale or else saturated at 8."""
    faults = Faults(missing=0.1, zero=0.2, stale=0.3, saturated_ms=8.0)
    assert faults.report(TRUTH, BEFORE, dice) == pytest.approx(expected, nan_ok=True)


def test_without_faults_a_report_is_the_truth() -> None:
    """No share, no fault, whatever the die."""
    assert Faults().report(TRUTH, BEFORE, 0.0) == TRUTH


@pytest.mark.parametrize(
    "shares",
    [{"missing": -0.1}, {"zero": 1.1}, {"missing": 0.6, "stale": 0.6}, {"stale": math.nan}],
)
def test_impossible_shares_are_refused(shares: dict[str, float]) -> None:
    """Shares outside [0, 1], or with a sum above 1, are errors."""
    with pytest.raises(InputError, match=r"expected shares in \[0, 1\] with sum <= 1"):
        Faults(**shares)


def test_saturation_at_nothing_is_refused() -> None:
    """A timer that never exceeds 0 ms is an error."""
    with pytest.raises(InputError, match="expected saturated_ms > 0"):
        Faults(saturated_ms=0.0)
