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


def test_centres_are_at_rest_but_for_those_that_move() -> None:
    """Of three spheres one goes round: its x and y move, heights and the others stay, at any time.

    What was handed out earlier stays as it was.
    """
    rest_m = np.arange(9.0).reshape(3, 3)
    motion = Motion(np.array([1]), np.array([2.0]), np.array([math.pi]), np.array([0.0]))
    centers = Centers(rest_m, motion)
    early_m = centers.at(0.5)
    expected = np.vstack((rest_m.T, np.ones(3)))
    assert centers.at(0.0) == pytest.approx(expected)
    expected[:2, 1] += (-2.0, 2.0)
    assert early_m == pytest.approx(expected)
    assert not early_m.flags.writeable


def test_centres_of_a_scene_at_rest_are_one_array() -> None:
    """Where nothing moves nothing is copied from frame to frame."""
    centers = Centers(np.arange(6.0).reshape(2, 3), None)
    assert centers.at(3.0) is centers.at(7.0)
    assert centers.at(0.0).tolist() == [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0], [1.0, 1.0]]


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
