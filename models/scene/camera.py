"""A pinhole camera and the projection of bounding spheres.

The camera looks along -z of its own frame, +x to the right and +y up.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError

_BLOCK = 16_000  # points for which BLAS starts no threads
_LEAST = 1e-300  # is lost in any length


@dataclass(frozen=True, slots=True)
class Camera:
    """Pose and lens of one frame.

    Attributes
    ----------
    position_m : (x, y, z)
    orientation_xyzw : unit quaternion from camera frame to scene frame
    width_px, height_px : viewport
    fovy_rad : vertical field of view, in (0, π)
    near_m : near plane, positive
    focal_px : derived, height / (2 tan(fovy / 2))
    pose : (3, 4) float64, derived
        The axes, and what a point at the scene's origin has along them: a product with
        (x, y, z, 1) gives coordinates in the camera's frame.
    """

    position_m: tuple[float, float, float]
    orientation_xyzw: tuple[float, float, float, float]
    width_px: int
    height_px: int
    fovy_rad: float
    near_m: float = 0.1
    focal_px: float = field(init=False)
    pose: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.fovy_rad < math.pi or self.near_m <= 0.0:
            raise InputError("camera: expected field of view in (0, 180) degrees and near > 0")
        focal_px = self.height_px / (2.0 * math.tan(self.fovy_rad / 2.0))
        object.__setattr__(self, "focal_px", focal_px)
        object.__setattr__(self, "pose", _pose(self.position_m, self.orientation_xyzw))

    @property
    def axes(self) -> FloatArray:
        """Rows: the camera's right, up and forward directions in the scene frame, (3, 3)."""
        return self.pose[:, :3]

    @property
    def viewport_px(self) -> int:
        """Pixels of the viewport."""
        return self.width_px * self.height_px

    def place(self, points: FloatArray) -> FloatArray:
        """Return (3, n) right, up and forward coordinates of (4, n) points (x, y, z, 1), read-only.

        Raises `ValueError` if points are without their row of ones.
        """
        n = points.shape[1]
        if n <= _BLOCK:
            local_m = np.matmul(self.pose, points)
        else:
            local_m = np.empty((3, n))
            for start in range(0, n, _BLOCK):
                part = slice(start, start + _BLOCK)
                np.matmul(self.pose, points[:, part], out=local_m[:, part])
        local_m.setflags(write=False)
        return local_m

    def to_camera(self, points_m: FloatArray) -> FloatArray:
        """Return (3, n) right, up and forward coordinates of (3, n) scene points."""
        origin_m = self.pose[:, 3:]
        if points_m.shape[1] <= _BLOCK:
            local_m = self.axes @ points_m
            local_m += origin_m
            return local_m
        parts = np.split(points_m, range(_BLOCK, points_m.shape[1], _BLOCK), axis=1)
        return np.concatenate([self.axes @ part + origin_m for part in parts], axis=1)


def _pose(
    position_m: tuple[float, float, float], orientation_xyzw: tuple[float, float, float, float]
) -> FloatArray:
    """Return a camera's pose, read-only: once a frame, hence in plain numbers.

    The axes are the rows of the transposed rotation matrix, the last one negated: cameras look
    along -z.
    """
    (x, y, z, w), (px, py, pz) = orientation_xyzw, position_m
    ax, ay, az = 1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)
    bx, by, bz = 2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)
    cx, cy, cz = -2 * (x * z + y * w), -2 * (y * z - x * w), 2 * (x * x + y * y) - 1
    a = -(ax * px + ay * py + az * pz)
    b = -(bx * px + by * py + bz * pz)
    c = -(cx * px + cy * py + cz * pz)
    pose = np.array(((ax, ay, az, a), (bx, by, bz, b), (cx, cy, cz, c)), dtype=np.float64)
    pose.setflags(write=False)
    return pose


def projected_area_px(
    depth_m: FloatArray, distance_m: FloatArray, radius_m: FloatArray, camera: Camera
) -> FloatArray:
    """Return the projected area of bounding spheres in px, at most the viewport's, (n,).

    The perspective image of a sphere at forward depth z and distance l is an ellipse of area
    ``π f² r² sqrt((l² - r²) / (z² - r²)) / (z² - r²)``.  A sphere that reaches the near plane has
    no such ellipse (its image is unbounded or wraps the eye) and counts as the whole viewport.
    """
    square = radius_m * radius_m
    near = depth_m - radius_m <= camera.near_m
    return area_of_spheres(
        depth_m * depth_m - square,
        distance_m * distance_m - square,
        math.pi * camera.focal_px**2 * square,
        near,
        float(camera.viewport_px),
    )


def area_of_spheres(
    gap_m2: FloatArray, out_m2: FloatArray, disc: FloatArray, near: BoolArray, limit_px: float
) -> FloatArray:
    """Return `projected_area_px` of ``z² - r²``, ``l² - r²`` and ``π f² r²``, all (n,).

    `near` says which spheres reach the near plane.  The first two arrays are overwritten.
    """
    area = out_m2
    at = near.nonzero()[0]
    if len(at):  # beyond the near plane both are positive
        np.maximum(gap_m2, 1e-30, out=gap_m2)
        np.maximum(area, 0.0, out=area)
    area /= gap_m2
    np.sqrt(area, out=area)
    area *= disc
    area /= gap_m2
    np.minimum(area, limit_px, out=area)
    if len(at):
        area[at] = limit_px
    return area


def eccentricity_deg(depth_m: FloatArray, distance_m: FloatArray) -> FloatArray:
    """Return angles between the view axis and directions to points, degrees in [0, 180]."""
    # Changes nothing but 0 / 0 to 1: what is at the eye is on the axis.
    ratio = depth_m + _LEAST
    ratio /= distance_m + _LEAST
    np.minimum(np.maximum(ratio, -1.0, out=ratio), 1.0, out=ratio)
    angle_deg = np.arccos(ratio, out=ratio)
    angle_deg *= math.degrees(1.0)
    return angle_deg
