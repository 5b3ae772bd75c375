"""A pinhole camera and the projection of bounding spheres.

The camera looks along -z of its own frame, +x to the right and +y up.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import FloatArray, derive
from ...base.errors import InputError

_BLOCK = 16_000  # points for which BLAS starts no threads


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
    axes : (3, 3) float64, derived
        Rows: the camera's right, up and forward directions in the scene frame.
    eye_m : (3,) float64, derived
        The position along the axes.
    """

    position_m: tuple[float, float, float]
    orientation_xyzw: tuple[float, float, float, float]
    width_px: int
    height_px: int
    fovy_rad: float
    near_m: float = 0.1
    focal_px: float = field(init=False)
    axes: FloatArray = field(init=False, repr=False)
    eye_m: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.fovy_rad < math.pi or self.near_m <= 0.0:
            raise InputError("camera: expected field of view in (0, 180) degrees and near > 0")
        axes, eye_m = _place(self.position_m, self.orientation_xyzw)
        focal_px = self.height_px / (2.0 * math.tan(self.fovy_rad / 2.0))
        derive(self, focal_px=focal_px, axes=axes, eye_m=eye_m)

    @property
    def viewport_px(self) -> int:
        """Pixels of the viewport."""
        return self.width_px * self.height_px

    def to_camera(self, points_m: FloatArray) -> FloatArray:
        """Return (3, n) right, up and forward coordinates of (3, n) scene points."""
        eye_m = self.eye_m[:, None]
        if points_m.shape[1] <= _BLOCK:
            local_m = self.axes @ points_m
            local_m -= eye_m
            return local_m
        parts = np.split(points_m, range(_BLOCK, points_m.shape[1], _BLOCK), axis=1)
        return np.concatenate([self.axes @ part - eye_m for part in parts], axis=1)


def _place(
    position_m: tuple[float, float, float], orientation_xyzw: tuple[float, float, float, float]
) -> tuple[FloatArray, FloatArray]:
    """Return a camera's axes and the position along them: once a frame, hence in plain numbers.

    The axes are the rows of the transposed rotation matrix, the last one negated: cameras look
    along -z.
    """
    (x, y, z, w), (px, py, pz) = orientation_xyzw, position_m
    ax, ay, az = 1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)
    bx, by, bz = 2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)
    cx, cy, cz = -2 * (x * z + y * w), -2 * (y * z - x * w), 2 * (x * x + y * y) - 1
    eye = (ax * px + ay * py + az * pz, bx * px + by * py + bz * pz, cx * px + cy * py + cz * pz)
    numbers = np.array((ax, ay, az, bx, by, bz, cx, cy, cz, *eye), dtype=np.float64)
    numbers.flags.writeable = False
    return numbers[:9].reshape(3, 3), numbers[9:]


def projected_area_px(
    depth_m: FloatArray,
    distance_m: FloatArray,
    radius_m: FloatArray,
    camera: Camera,
    square_m2: FloatArray | None = None,
) -> FloatArray:
    """Return the projected area of bounding spheres in px, at most the viewport's, (n,).

    The perspective image of a sphere at forward depth z and distance l is an ellipse of area
    ``π f² r² sqrt((l² - r²) / (z² - r²)) / (z² - r²)``.  A sphere that reaches the near plane has
    no such ellipse (its image is unbounded or wraps the eye) and counts as the whole viewport.
    `square_m2` is r² where it is known.
    """
    square = radius_m * radius_m if square_m2 is None else square_m2
    near = depth_m - radius_m <= camera.near_m
    some_near = np.count_nonzero(near)
    gap = depth_m * depth_m
    gap -= square
    area = distance_m * distance_m
    area -= square
    if some_near:  # beyond the near plane both are positive
        np.maximum(gap, 1e-30, out=gap)
        np.maximum(area, 0.0, out=area)
    area /= gap
    np.sqrt(area, out=area)
    area *= square
    area *= math.pi * camera.focal_px**2
    area /= gap
    limit = float(camera.viewport_px)
    np.minimum(area, limit, out=area)
    if some_near:
        area[near] = limit
    return area


def eccentricity_deg(depth_m: FloatArray, distance_m: FloatArray) -> FloatArray:
    """Return angles between the view axis and directions to points, degrees in [0, 180]."""
    ratio = np.divide(depth_m, distance_m, out=np.ones_like(depth_m), where=distance_m > 0)
    return np.degrees(np.arccos(np.clip(ratio, -1.0, 1.0)))
