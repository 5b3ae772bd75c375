"""Rotation of vectors by unit quaternions ``x y z w``."""

from collections.abc import Iterable

import numpy as np

from ...base.arrays import FloatArray


def rotate(orientation_xyzw: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rotate (n, 3) vectors by (n, 4) unit quaternions: v + 2 q × (q × v + w v)."""
    axis, w = orientation_xyzw[..., :3], orientation_xyzw[..., 3:]
    return vectors + 2.0 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def turn_about_z(yaw_rad: FloatArray) -> FloatArray:
    """Return the (n, 4) quaternions of turns about the vertical, (n,)."""
    zero = np.zeros(len(yaw_rad))
    return np.stack((zero, zero, np.sin(yaw_rad / 2.0), np.cos(yaw_rad / 2.0)), axis=1)


def rotation_matrix(orientation_xyzw: Iterable[float]) -> FloatArray:
    """Return the (3, 3) matrix whose columns are the rotated axes of one unit quaternion."""
    x, y, z, w = orientation_xyzw
    return np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        )
    )
