"""Moving nodes: circles through the rest position."""

import math

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.motion import Centers, Motion


def test_a_circle_by_hand() -> None:
    """A radius of 2 m and half a turn a second: after a quarter turn it is at (-2, 2)."""
    motion = Motion(np.array([3]), np.array([2.0]), np.array([math.pi]), np.array([0.0]))
    assert motion.offset_m(0.0) == pytest.approx(np.zeros((2, 1)))
    assert motion.offset_m(0.5) == pytest.approx(np.array([[-2.0], [2.0]]))
    assert motion.offset_m(1.0) == pytest.approx(np.array([[-4.0], [0.0]]))
    assert motion.offset_m(2.0) == pytest.approx(np.zeros((2, 1)), abs=1e-12)


def test_speed_is_radius_times_rate() -> None:
    """Whatever the phase, every node moves at radius times rate."""
    rng = np.random.default_rng(0)
    radius, rate = rng.uniform(0, 5, 20), rng.uniform(-3, 3, 20)
    motion = Motion(np.arange(20), radius, rate, rng.uniform(0, 6, 20))
    step = (motion.offset_m(1.7 + 1e-6) - motion.offset_m(1.7 - 1e-6)) / 2e-6
    assert np.linalg.norm(step, axis=0) == pytest.approx(radius * np.abs(rate), rel=1e-6)


def test_a_series_is_the_circle_nearby() -> None:
    """Half a radian off, 14 terms of the series agree with sine and cosine."""
    rng = np.random.default_rng(1)
    rate = rng.uniform(-3, 3, 20)
    rate[0] = 3.0
    motion = Motion(np.arange(20), rng.uniform(0, 5, 20), rate, rng.uniform(0, 6, 20))
    series = motion.series(7.0, 14)
    for since_s in (-0.5 / 3.0, 0.0, 0.5 / 3.0):
        summed = np.einsum("k,kam->am", since_s ** np.arange(14), series)
        assert summed == pytest.approx(motion.offset_m(7.0 + since_s), rel=0, abs=1e-13)


def test_centres_are_at_rest_but_for_those_that_move() -> None:
    """Of three spheres one goes round: its x and y move, heights and the others stay, at any time.

    What was handed out earlier stays as it was.
    """
    rest_m = np.arange(9.0).reshape(3, 3)
    motion = Motion(np.array([1]), np.array([2.0]), np.array([math.pi]), np.array([0.0]))
    centers = Centers(rest_m, motion)
    early = centers.at(0.5)
    expected = rest_m.T.copy()
    assert centers.at(0.0).all_m == pytest.approx(expected)
    expected[:2, 1] += (-2.0, 2.0)
    assert early.moved_m == pytest.approx(expected[:2, [1]])
    assert early.all_m == pytest.approx(expected)
    assert early.all_m is early.all_m
    assert not early.all_m.flags.writeable
    assert not early.moved_m.flags.writeable


@pytest.mark.parametrize("count", [1, 300, 1_000])
@pytest.mark.parametrize("fastest_rad_s", [0.0, 0.3, 40.0])
def test_centres_are_on_their_circles_whenever_asked(count: int, fastest_rad_s: float) -> None:
    """At times in any order, early and after hours, centres are rest plus displacement."""
    rng = np.random.default_rng(count)
    rest_m, node = rng.uniform(-50, 50, (2 * count, 3)), np.arange(0, 2 * count, 2)
    rate = fastest_rad_s * rng.uniform(-1, 1, count)
    motion = Motion(node, rng.uniform(0, 4, count), rate, rng.uniform(0, 6, count))
    centers = Centers(rest_m, motion)
    times_s = (0.0, 0.01, 3.0, 2.99, 3.0, 700.0, 36_000.0)
    first = {time_s: centers.at(time_s).all_m for time_s in times_s}
    for time_s, placed_m in first.items():
        expected = rest_m.T.copy()
        expected[:2, node] += motion.offset_m(time_s)
        # Angles after hours are themselves rounded.
        assert placed_m == pytest.approx(
            expected, rel=0, abs=1e-13 + 1e-15 * time_s * fastest_rad_s
        )
        assert Centers(rest_m, motion).at(time_s).all_m.tolist() == placed_m.tolist()


def test_centres_of_a_scene_at_rest_are_one_array() -> None:
    """Where nothing moves nothing is copied from frame to frame."""
    centers = Centers(np.arange(6.0).reshape(2, 3), None)
    assert centers.at(3.0) is centers.at(7.0)
    assert centers.at(0.0).all_m.tolist() == [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0]]
    assert centers.rest_m.tolist() == [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0], [1.0, 1.0]]


@pytest.mark.parametrize("field", [1, 2, 3])
def test_motion_without_numbers_is_refused(field: int) -> None:
    """NaN and arrays of another length are errors that name the array."""
    arrays = [np.array([0]), np.array([1.0]), np.array([1.0]), np.array([0.0])]
    broken = list(arrays)
    broken[field] = np.array([np.nan])
    with pytest.raises(InputError, match=r"motion .*: expected finite"):
        Motion(*broken)
    broken[field] = np.array([1.0, 2.0])
    with pytest.raises(InputError, match=r"motion .*: expected shape"):
        Motion(*broken)
