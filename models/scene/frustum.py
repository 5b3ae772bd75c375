"""Frustum culling of bounding spheres, block by block over struct-of-arrays buffers."""

import math

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .camera import Camera
from .cells import Cells

_BLOCK = 16_000  # nodes whose buffers fit a core's cache; BLAS starts no threads for so few


class Culler:
    """Culls the spheres of N nodes against one camera after another.

    `inside`, (N,) bool and read-only, holds the last answer as a mask; the next cull overwrites it.

    A sphere is a candidate unless it lies wholly outside one of the four side planes or the near
    plane; there is no far plane.  This keeps some spheres that only meet the planes' extensions,
    as engines' sphere tests do, and never drops one that is in view.  With `cells`, what walls hide
    is dropped too.
    """

    __slots__ = ("_cells", "_keep", "_mask", "_radius_m", "_reach", "_side", "_xyz_m", "inside")

    def __init__(self, radius_m: FloatArray, cells: Cells | None = None) -> None:
        size = min(_BLOCK, len(radius_m))
        self._radius_m = radius_m
        self._cells = cells
        self._xyz_m = np.empty((3, size))
        self._side = np.empty(size)
        self._reach = np.empty(size)
        self._mask = np.empty(size, dtype=np.bool_)
        self._keep = np.empty(len(radius_m), dtype=np.bool_)
        self.inside = self._keep.view()
        self.inside.flags.writeable = False

    def cull(self, centers_m: FloatArray, camera: Camera) -> tuple[IntArray, FloatArray]:
        """Return ids of candidates, ascending, and their (3, m) camera coordinates; read-only.

        `centers_m` is (3, N): scene coordinates of the spheres' centres.
        """
        axes = camera.axes
        eye: list[float] = (axes @ camera.position_m).tolist()
        blocks = range(0, len(self._radius_m), _BLOCK)
        parts = [self._cull_block(start, centers_m, camera, eye) for start in blocks]
        ids, xyz_m = parts[0]
        if len(parts) > 1:
            ids = np.concatenate([part[0] for part in parts])
            xyz_m = np.concatenate([part[1] for part in parts], axis=1)
        ids.flags.writeable = xyz_m.flags.writeable = False
        return ids, xyz_m

    def _cull_block(
        self, start: int, centers_m: FloatArray, camera: Camera, eye: list[float]
    ) -> tuple[IntArray, FloatArray]:
        radius_m = self._radius_m[start : start + _BLOCK]
        keep = self._keep[start : start + _BLOCK]
        size = len(radius_m)
        xyz, side, reach = self._xyz_m[:, :size], self._side[:size], self._reach[:size]
        mask = self._mask[:size]
        np.matmul(camera.axes, centers_m[:, start : start + size], out=xyz)
        for row in range(3):
            xyz[row] -= eye[row]
        np.subtract(camera.near_m, radius_m, out=side)
        np.greater(xyz[2], side, out=keep)
        for row, pixels in ((0, camera.width_px), (1, camera.height_px)):
            # Outside where |x| cos a - z sin a > r, that is |x| > z tan a + r / cos a.
            tangent = 0.5 * pixels / camera.focal_px
            np.multiply(xyz[2], tangent, out=reach)
            np.multiply(radius_m, math.hypot(1.0, tangent), out=side)
            reach += side
            np.abs(xyz[row], out=side)
            np.less_equal(side, reach, out=mask)
            keep &= mask
        if self._cells is not None:
            keep &= self._cells.seen_from(camera.position_m)[start : start + _BLOCK]
        at = keep.nonzero()[0]
        return (at + start).astype(np.int32), xyz.take(at, axis=1)
