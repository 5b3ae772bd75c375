"""Rotations from what files have in their place: printed matrices, quaternions, directions."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray, refuse_rows
from ..camera_trace import Repair
from ..samples import MAX_NORM_ERROR, ROUNDING


def nearest_rotations(
    matrices: FloatArray, path: Path, lines: Sequence[int]
) -> tuple[FloatArray, tuple[Repair, ...]]:
    """Return the nearest rotation (polar decomposition) of each of (n, 3, 3) matrices.

    And what was repaired: those off by more than the rounding of printed digits.  Raises
    `InputError` with the line of the first that is none.
    """
    clipped = np.clip(matrices, -2.0, 2.0)  # what is larger is refused, and must not overflow
    product = clipped @ np.swapaxes(clipped, 1, 2)
    error = np.abs(product - np.eye(3)).max(axis=(1, 2), initial=0.0)
    refuse_rows(
        (error > MAX_NORM_ERROR) | (np.linalg.det(clipped) <= 0.0),
        lambda _: (
            "expected the first three columns to be a rotation, got a matrix whose rows are not "
            "right-handed unit vectors at right angles; check the order of the numbers"
        ),
        path=path,
        lines=lines,
    )
    left, _, right = np.linalg.svd(matrices)
    projected = int(np.sum(error > ROUNDING))
    repairs = (Repair(projected, "matrices made rotations"),) if projected else ()
    return left @ right, repairs


def rotations_of(quaternions_xyzw: FloatArray, path: Path, lines: Sequence[int]) -> FloatArray:
    """Return (n, 3, 3) matrices; raises `InputError` with the line of what is no quaternion."""
    from scipy.spatial.transform import Rotation

    norm = np.linalg.norm(np.clip(quaternions_xyzw, -2.0, 2.0), axis=1)
    refuse_rows(
        np.abs(norm - 1.0) > MAX_NORM_ERROR,
        lambda row: (
            f"expected a unit quaternion, got one of norm {norm[row]:.6g}; "
            "check the order of the columns"
        ),
        path=path,
        lines=lines,
    )
    matrices: FloatArray = Rotation.from_quat(quaternions_xyzw).as_matrix()
    return matrices


def rotations_along(
    ahead: FloatArray,
    up: FloatArray,
    path: Path,
    lines: Sequence[int],
    *,
    left_handed: bool,
) -> FloatArray:
    """Return (n, 3, 3) matrices whose columns are right, up and back of cameras.

    Raises `InputError` with the line of the first whose directions are none, or are one.

    Parameters
    ----------
    ahead, up : (n, 3)
        In the file's world; `up` need not be at right angles.
    left_handed
        Whether that world is: right is then up x ahead.
    """
    right: FloatArray = np.cross(up, ahead) if left_handed else np.cross(ahead, up)
    sizes = np.stack([np.linalg.norm(some, axis=1) for some in (ahead, right)])
    refuse_rows(
        ~np.all((sizes > 1e-3) & (sizes < 1e3), axis=0),
        lambda _: (
            "expected two directions, ahead and up, got none or the same twice; "
            "check the columns, or remove the row"
        ),
        path=path,
        lines=lines,
    )
    ahead = ahead / sizes[0][:, np.newaxis]
    right = right / sizes[1][:, np.newaxis]
    true_up: FloatArray = np.cross(ahead, right) if left_handed else np.cross(right, ahead)
    return np.stack((right, true_up, -ahead), axis=2)
