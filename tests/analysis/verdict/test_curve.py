"""Trade-off curves, and the area between two of them integrated by hand."""

import math
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.verdict.curve import Curve, area_between
from lodbench.analysis.verdict.intervals import such_paths

PATHS = np.array([0.9, 1.0, 1.0, 1.2])


def curve(work_ms: list[float], error_px: list[float]) -> Curve:
    """Return a curve of these means, on four paths that differ in work and error."""
    work, error = (np.array(of)[:, None] * PATHS for of in (work_ms, error_px))
    nothing = np.zeros_like(work)
    return Curve(np.arange(len(work) * 1.0), work, 0.6 * work, error, nothing, nothing)


def alone(work_ms: list[float], error_px: list[float]) -> Curve:
    """Return a curve on a single path."""
    work, error = np.array(work_ms)[:, None], np.array(error_px)[:, None]
    nothing = np.zeros_like(work)
    return Curve(np.arange(len(work) * 1.0), work, 0.6 * work, error, nothing, nothing)


def test_half_the_error_everywhere_is_minus_fifty_per_cent() -> None:
    """A constant factor is the mean, whatever the shape of both curves."""
    a = curve([2.0, 4.0, 7.0, 16.0], [8.0, 3.0, 2.5, 0.4])
    b = curve([2.0, 4.0, 7.0, 16.0], [4.0, 1.5, 1.25, 0.2])
    assert area_between(a, b) == pytest.approx(-50.0)
    assert area_between(b, a) == pytest.approx(100.0)
    assert area_between(a, a) == pytest.approx(0.0)


def test_power_laws_by_hand() -> None:
    """Errors 8 / w and 8 / w² over work 2 to 8: ln of their ratio is −ln w, −ln 4 in the mean."""
    work = [1.0, 2.0, 4.0, 8.0]
    a, b = curve(work[1:], [4.0, 2.0, 1.0]), curve(work, [8.0, 2.0, 0.5, 0.125])
    # Paths scale work and error alike on both curves, which moves the common range a little.
    shift = float(np.log(PATHS).mean())
    mean = -(math.log(4.0) + shift) + shift
    assert area_between(a, b) == pytest.approx(100 * math.expm1(mean), rel=1e-9)


def test_a_bend_by_hand() -> None:
    """PCHIP through ln error 0, 1, 1 at ln work 0, 1, 2 has slopes 2 (limited), 0, 0.

    On [0, 1] the Hermite cubic with slopes m and 0 has the area ½ + m / 12; on [1, 2] it is 1.
    The end slope is the three-point (3 · 1 − 0) / 2 = 1.5, within its limit of 3.
    """
    flat = curve([1.0, math.e, math.e**2], [1.0, 1.0, 1.0])
    bent = curve([1.0, math.e, math.e**2], [1.0, math.e, math.e])
    mean = (0.5 + 1.5 / 12 + 1.0) / 2
    assert area_between(flat, bent) == pytest.approx(100 * math.expm1(mean), rel=1e-9)


def test_area_agrees_with_another_library() -> None:
    """Bjøntegaard's rate at equal quality is our error at equal work, to a millionth."""
    bjontegaard: Any = pytest.importorskip("bjontegaard")
    work, error = [2.0, 3.1, 5.0, 9.5, 16.0], [8.0, 5.5, 2.6, 1.2, 0.4]
    other_work, other_error = [2.5, 4.0, 6.0, 8.0, 14.0], [7.9, 4.4, 1.9, 1.3, 0.3]
    oracle = bjontegaard.bd_rate(error, np.log(work), other_error, np.log(other_work), "pchip")
    curves = alone(work, error), alone(other_work, other_error)
    assert area_between(*curves) == pytest.approx(oracle, rel=1e-6)


def test_only_the_common_range_counts() -> None:
    """Beyond the work that both reach a curve may do what it likes."""
    a = curve([2.0, 4.0, 8.0], [4.0, 2.0, 1.0])
    b = curve([4.0, 8.0], [4.0, 2.0])
    assert area_between(a, b) == pytest.approx(100.0)


def test_no_common_range() -> None:
    """Curves that share no work, or have a single point of it, cannot be compared."""
    a, b = curve([1.0, 2.0], [4.0, 2.0]), curve([3.0, 4.0], [4.0, 2.0])
    assert area_between(a, b) is None
    assert area_between(a, curve([1.5], [1.0])) is None
    assert area_between(a, curve([1.5, 1.5], [1.0, 2.0])) is None


def test_order_and_repeats_of_points_do_not_matter() -> None:
    """Work need not rise along the knob; of two points of equal work the finer picture counts."""
    a = curve([2.0, 4.0, 8.0], [4.0, 2.0, 1.0])
    b = curve([8.0, 2.0, 4.0, 4.0], [2.0, 8.0, 4.0, 9.0])
    assert area_between(a, b) == pytest.approx(100.0)


def test_errors_that_nobody_can_measure_are_taken_as_a_hundredth() -> None:
    """A picture without error is finite per cent better, not infinitely."""
    a, b = curve([2.0, 8.0], [1.0, 1.0]), curve([2.0, 8.0], [0.0, 0.0])
    area = area_between(a, b)
    assert area is not None
    assert -99.5 < area < -98.0


def test_each_point_has_its_interval() -> None:
    """Along the knob, the interval over such paths."""
    a = curve([2.0, 8.0], [4.0, 1.0])
    found = a.interval("error_px")
    assert found == (such_paths(a.error_px[0], "positive"), such_paths(a.error_px[1], "positive"))
    assert len(a.interval("pops_per_s")) == 2
