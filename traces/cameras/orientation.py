"""Orientations as unit quaternions ``x y z w``: view directions and changes of camera frame."""

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import FloatArray


def look_along(heading_rad: ArrayLike, pitch_rad: ArrayLike) -> FloatArray:
    """Orientations (n, 4) of level cameras.

    ``heading_rad`` is counter-clockwise from +x seen from above, ``pitch_rad`` is up from the
    horizon. With both 0 the camera looks along +x.
    """
    # R = Rz(heading - 90 deg) Rx(90 deg + pitch): Rx turns -z up to the pitch above +y, Rz turns
    # +y to the heading.
    half_z = 0.5 * (np.asarray(heading_rad, dtype=np.float64) - 0.5 * np.pi)
    half_x = 0.5 * (np.asarray(pitch_rad, dtype=np.float64) + 0.5 * np.pi)
    cz, sz, cx, sx = np.cos(half_z), np.sin(half_z), np.cos(half_x), np.sin(half_x)
    return np.stack([cz * sx, sz * sx, sz * cx, cz * cx], axis=-1)


def view_direction(orientation_xyzw: FloatArray) -> FloatArray:
    """Directions (n, 3) in which cameras look: their -z axes in the scene frame, unit vectors."""
    x, y, z, w = np.moveaxis(orientation_xyzw, -1, 0)
    return -np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=-1)


def camera_from_optical(orientation_xyzw: FloatArray) -> FloatArray:
    """Orientations (n, 4) of cameras given as optical frames: +z ahead, +x right, +y down.

    The two frames differ by half a turn about x, the quaternion (1, 0, 0, 0) on the right.
    """
    x, y, z, w = np.moveaxis(orientation_xyzw, -1, 0)
    return np.stack([w, z, -y, -x], axis=-1)


def optical_from_camera(orientation_xyzw: FloatArray) -> FloatArray:
    """Inverse of `camera_from_optical`, to the last bit."""
    x, y, z, w = np.moveaxis(orientation_xyzw, -1, 0)
    return np.stack([-w, -z, y, x], axis=-1)


def turn_deg(first_xyzw: FloatArray, second_xyzw: FloatArray) -> FloatArray:
    """Angle (n,) from 0 to 180 degrees between orientations, precise for small angles too."""
    # |q - r| and |q + r| are twice the sine and the cosine of a quarter of the turn.
    apart = np.linalg.norm(first_xyzw - second_xyzw, axis=-1)
    together = np.linalg.norm(first_xyzw + second_xyzw, axis=-1)
    return np.degrees(4.0 * np.arctan2(np.minimum(apart, together), np.maximum(apart, together)))


def turn_by(orientation_xyzw: FloatArray, yaw_rad: ArrayLike, pitch_rad: ArrayLike) -> FloatArray:
    """Orientations (n, 4) of cameras turned about the scene's z, then up about their own x."""
    half_z = 0.5 * np.asarray(yaw_rad, dtype=np.float64)
    half_x = 0.5 * np.asarray(pitch_rad, dtype=np.float64)
    cz, sz, cx, sx = np.cos(half_z), np.sin(half_z), np.cos(half_x), np.sin(half_x)
    x, y, z, w = np.moveaxis(orientation_xyzw, -1, 0)
    # The yaw stands on the left, being of the scene; the pitch on the right.
    x, y, z, w = cz * x - sz * y, cz * y + sz * x, cz * z + sz * w, cz * w - sz * z
    turned = (x * cx + w * sx, y * cx + z * sx, z * cx - y * sx, w * cx - x * sx)
    return np.stack(turned, axis=-1) / np.linalg.norm(turned, axis=0)[:, np.newaxis]
