"""Frustum culling of bounding spheres, block by block over struct-of-arrays buffers."""

import math

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .camera import Camera
from .cells import Cells

_BLOCK = 8_000  # spheres whose buffers fit a core's cache; BLAS starts no threads for so few


class Culler:
    """Culls the spheres of N nodes against one camera after another.

    `inside`, (N,) bool and read-only, holds the last answer as a mask; the next cull overwrites it.

    A sphere is a candidate unless it lies wholly outside one of the four side planes or the near
    plane; there is no far plane.  This keeps some spheres that only meet the planes' extensions,
    as engines' sphere tests do, and never drops one that is in view.  With `cells`, what walls hide
    is dropped too.
    """

    def __init__(self, radius_m: FloatArray, cells: Cells | None = None) -> None:
        n = len(radius_m)
        size = min(_BLOCK, n)
        self._cells = cells
        # Columns (x, y, z, 1, radius): one product with rows (normal, offset, 1) tells how far
        # each sphere reaches inside each plane.
        self._spheres = np.ones((5, n))
        self._spheres[4] = radius_m
        self._placed: FloatArray | None = None
        self._lens: tuple[float, ...] = ()
        self._local = np.zeros((5, 5))  # the planes in the camera's frame
        self._pose = np.eye(5)
        self._planes = np.zeros((5, 5))
        self._reach_m = np.empty((5, size))
        self._least_m = np.empty(size)
        self._keep = np.zeros(n, dtype=np.bool_)
        self._last_keep = b""
        self._at = np.zeros(0, dtype=np.intp)
        self._ids: IntArray = self._at.astype(np.int32)
        self.inside = self._keep.view()
        self.inside.flags.writeable = False

    def cull(self, centers_m: FloatArray, camera: Camera) -> tuple[IntArray, FloatArray]:
        """Return ids of candidates, ascending, and their (3, m) camera coordinates; read-only.

        `centers_m` is (3, N): scene coordinates of the spheres' centres.  Where the candidates are
        those of the cull before, the ids are the same array.
        """
        if centers_m is not self._placed:
            self._spheres[:3] = centers_m
            # Whoever may write to the array may have done so by the next cull.
            self._placed = None if centers_m.flags.writeable else centers_m
        self._place_planes(camera)
        for start in range(0, len(self._keep), _BLOCK):
            self._cull_block(start)
        if self._cells is not None:
            np.logical_and(self._keep, self._cells.seen_from(camera.position_m), out=self._keep)
        # Candidates often stay, and to compare masks takes less time than to gather anew.
        keep = self._keep.tobytes()
        if keep != self._last_keep:
            self._last_keep = keep
            self._at = self._keep.nonzero()[0]
            self._ids = self._at.astype(np.int32)
            self._ids.flags.writeable = False
        xyz_m = camera.to_camera(centers_m.take(self._at, axis=1))
        xyz_m.flags.writeable = False
        return self._ids, xyz_m

    def _cull_block(self, start: int) -> None:
        keep = self._keep[start : start + _BLOCK]
        size = len(keep)
        reach_m, least_m = self._reach_m[:, :size], self._least_m[:size]
        np.matmul(self._planes, self._spheres[:, start : start + size], out=reach_m)
        np.minimum.reduce(reach_m, axis=0, out=least_m)
        np.greater_equal(least_m, 0.0, out=keep)

    def _place_planes(self, camera: Camera) -> None:
        """Turn the planes, whose normals point inwards, to where the camera is."""
        lens = (camera.width_px, camera.height_px, camera.focal_px, camera.near_m)
        if lens != self._lens:
            self._lens = lens
            self._local = _local_planes(*lens)
        pose = self._pose
        pose[:3, :3] = camera.axes
        np.negative(camera.eye_m, out=pose[:3, 3])
        np.matmul(self._local, pose, out=self._planes)


def _local_planes(width_px: float, height_px: float, focal_px: float, near_m: float) -> FloatArray:
    """Return rows (normal, offset, 1) of the planes in the camera's frame, (5, 5).

    The sides are left and right, bottom and top; the last one is the near plane.
    """
    planes = np.zeros((5, 5))
    for axis, pixels in enumerate((width_px, height_px)):
        tangent = 0.5 * pixels / focal_px
        across = math.hypot(1.0, tangent)
        planes[2 * axis : 2 * axis + 2, axis] = 1.0 / across, -1.0 / across
        planes[2 * axis : 2 * axis + 2, 2] = tangent / across
    planes[4, 2:4] = 1.0, -near_m
    planes[:, 4] = 1.0
    return planes
