"""Ranges of values, as they would be written by hand."""

import pytest

from lodbench.analysis.study.axes.values import count_range, step_range
from lodbench.base.errors import InputError


def test_steps_are_decimal() -> None:
    """Values are what one would write, though 0.1 + 2 · 0.1 is 0.30000000000000004 in floats."""
    assert step_range(0.1, 0.5, 0.1) == [0.1, 0.2, 0.3, 0.4, 0.5]
    assert step_range(8, 20, 5) == [8, 13, 18]
    assert all(isinstance(value, int) for value in step_range(8, 20, 5))
    assert step_range(1, 0, -0.25) == [1.0, 0.75, 0.5, 0.25, 0.0]
    assert step_range(3, 3, 1) == [3]


def test_counts_hold_both_ends() -> None:
    """Equal steps and equal ratios, rounded to twelve digits; whole where all of it is."""
    assert count_range(0, 1, 5) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert count_range(0.001, 10, 5, log=True) == [0.001, 0.01, 0.1, 1.0, 10.0]
    assert count_range(1, 1000, 4, log=True) == [1, 10, 100, 1000]
    assert all(isinstance(value, int) for value in count_range(1, 1000, 4, log=True))
    assert count_range(1 / 3, 1, 2) == [1 / 3, 1.0]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: step_range(8, 16, -1), "step: expected steps that lead from 8 to 16, got -1"),
        (lambda: step_range(8, 16, 0), "step: expected steps"),
        (lambda: step_range(8, float("inf"), 1), "to: expected a finite number"),
        (lambda: step_range(0, 1, 1e-9), "range: expected at most 10,000,000 values"),
        (lambda: step_range(0, "b", 1), "to: expected a number, got 'b'"),  # pyright: ignore[reportArgumentType]
        (lambda: count_range(0, 1, 1), "count: expected a whole number >= 2"),
        (lambda: count_range(0, 1, 3, log=True), "log: expected ends above 0, got 0 and 1"),
    ],
)
def test_impossible_ranges_are_refused(make: object, said: str) -> None:
    """Ranges without values, without end, or without logarithm."""
    with pytest.raises(InputError, match=said):
        make()  # pyright: ignore[reportCallIssue, reportUnknownVariableType]
