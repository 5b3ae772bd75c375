"""Frustum culling of bounding spheres, in place over struct-of-arrays buffers."""

import math

import numpy as np

from ..models.arrays import FloatArray, IntArray
from ..models.camera import Camera

__all__ = ["Culler"]


class Culler:
    """Culls the spheres of N nodes against one camera after another.

    `inside`, (N,) bool, holds the last answer as a mask; the next cull overwrites it.

    A sphere is a candidate unless it lies wholly outside one of the four side planes or the near
    plane; there is no far plane.  This keeps some spheres that only meet the planes' extensions,
    as engines' sphere tests do, and never drops one that is in view.
    """

    __slots__ = ("_margin", "_mask", "_radius_m", "_side", "_xyz_m", "inside")

    def __init__(self, radius_m: FloatArray) -> None:
        n = len(radius_m)
        self._radius_m = radius_m
        self._xyz_m = np.empty((3, n))
        self._side = np.empty(n)
        self._margin = np.empty(n)
        self.inside = np.empty(n, dtype=np.bool_)
        self._mask = np.empty(n, dtype=np.bool_)

    def cull(self, centers_m: FloatArray, camera: Camera) -> tuple[IntArray, FloatArray]:
        """Return ids of candidates, ascending, and their (3, m) camera coordinates.

        `centers_m` is (3, N): scene coordinates of the spheres' centres.
        """
        xyz, keep, mask = self._xyz_m, self.inside, self._mask
        axes = camera.axes
        eye = axes @ camera.position_m
        np.matmul(axes, centers_m, out=xyz)
        for row in range(3):
            xyz[row] -= eye[row]
        tangent_y = 0.5 * camera.height_px / camera.focal_px
        tangent_x = 0.5 * camera.width_px / camera.focal_px
        np.greater(xyz[2], camera.near_m - self._radius_m, out=keep)
        for row, tangent in ((0, tangent_x), (1, tangent_y)):
            # Outside where |x| cos a - z sin a > r, that is |x| > z tan a + r / cos a.
            np.multiply(xyz[2], tangent, out=self._margin)
            np.multiply(self._radius_m, math.hypot(1.0, tangent), out=self._side)
            self._margin += self._side
            np.abs(xyz[row], out=self._side)
            np.less_equal(self._side, self._margin, out=mask)
            keep &= mask
        ids = np.flatnonzero(keep).astype(np.int32)
        return ids, xyz[:, ids]
