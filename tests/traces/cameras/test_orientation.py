"""View directions, changes of camera frame, and turn angles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lodbench.traces.cameras.orientation import (
    camera_from_optical,
    look_along,
    optical_from_camera,
    turn_deg,
    view_direction,
)


@pytest.mark.parametrize(
    ("heading_deg", "pitch_deg", "direction", "up"),
    [
        (0.0, 0.0, (1, 0, 0), (0, 0, 1)),
        (90.0, 0.0, (0, 1, 0), (0, 0, 1)),
        (180.0, 0.0, (-1, 0, 0), (0, 0, 1)),
        (0.0, 90.0, (0, 0, 1), (-1, 0, 0)),
        (0.0, -90.0, (0, 0, -1), (1, 0, 0)),
    ],
)
def test_level_cameras_look_where_they_are_told(
    heading_deg: float,
    pitch_deg: float,
    direction: tuple[int, int, int],
    up: tuple[int, int, int],
) -> None:
    """Heading turns from +x towards +y, pitch from the horizon to the zenith."""
    orientation = look_along(np.radians([heading_deg]), np.radians([pitch_deg]))
    assert np.allclose(view_direction(orientation), [direction], atol=1e-15)
    assert np.allclose(Rotation.from_quat(orientation).apply([0, 1, 0]), [up], atol=1e-15)


@given(seed=st.integers(0, 2**32 - 1))
def test_view_direction_is_the_turned_minus_z(seed: int) -> None:
    """The shortcut for -z agrees with scipy's rotation of (0, 0, -1)."""
    rotations = Rotation.random(20, rng=np.random.default_rng(seed))
    expected = rotations.apply([0.0, 0.0, -1.0])
    assert np.allclose(view_direction(rotations.as_quat()), expected, atol=1e-14)


def test_optical_frame_looks_along_z_with_y_down() -> None:
    """The camera's right, up and ahead are the optical frame's +x, -y and +z."""
    optical = Rotation.random(20, rng=np.random.default_rng(7))
    camera = Rotation.from_quat(camera_from_optical(optical.as_quat()))
    assert np.allclose(camera.apply([1, 0, 0]), optical.apply([1, 0, 0]), atol=1e-14)
    assert np.allclose(camera.apply([0, 1, 0]), optical.apply([0, -1, 0]), atol=1e-14)
    assert np.allclose(camera.apply([0, 0, -1]), optical.apply([0, 0, 1]), atol=1e-14)


def test_optical_frame_and_back_changes_no_bit() -> None:
    """Writing and reading a TUM file gives back the quaternions themselves."""
    quaternions = Rotation.random(20, rng=np.random.default_rng(8)).as_quat()
    assert np.array_equal(camera_from_optical(optical_from_camera(quaternions)), quaternions)


@pytest.mark.parametrize("angle_deg", [0.0, 1e-7, 1e-3, 1.0, 90.0, 179.0, 180.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_turn_is_the_angle_between(angle_deg: float, sign: float) -> None:
    """From tiny to half turns, and whichever of its two quaternions stands for a rotation."""
    start = Rotation.from_euler("xyz", [10.0, 20.0, 30.0], degrees=True)
    end = start * Rotation.from_rotvec([0.0, np.radians(angle_deg), 0.0])
    turned = turn_deg(start.as_quat()[np.newaxis], sign * end.as_quat()[np.newaxis])
    assert turned[0] == pytest.approx(angle_deg, rel=1e-6, abs=1e-12)
