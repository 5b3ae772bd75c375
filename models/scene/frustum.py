"""Frustum culling of bounding spheres, block by block over struct-of-arrays buffers."""

import math

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from .camera import Camera
from .cells import Cells

_BLOCK = 4_000  # spheres whose buffers fit a core's cache; BLAS starts no threads for so few
_PLANES = 5  # left, right, bottom, top and near


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
        self._behind_m = -radius_m  # how far behind a plane a centre may be
        self._lens: tuple[float, ...] = ()
        self._normals = np.zeros((_PLANES + 3, 3))
        self._local_m = np.empty((_PLANES + 3, size))
        self._least_m = np.empty(size)
        self._keep = np.zeros(n, dtype=np.bool_)
        self.inside = self._keep.view()
        self.inside.flags.writeable = False
        # Of the last cull, block by block: masks, positions, and the ids of all blocks.
        self._starts = range(0, n, _BLOCK)
        self._masks = [b""] * len(self._starts)
        self._at = [np.zeros(0, dtype=np.intp)] * len(self._starts)
        self._ids: IntArray = np.zeros(0, dtype=np.int32)

    def cull(self, centers_m: FloatArray, camera: Camera) -> tuple[IntArray, FloatArray]:
        """Return ids of candidates, ascending, and their (3, m) camera coordinates; read-only.

        `centers_m` is (3, N), scene coordinates of the spheres' centres, or (4, N) with a last row
        of ones.  Where the candidates are those of the cull before, the ids are the same array.
        """
        if len(centers_m) == 3:
            centers_m = np.concatenate((centers_m, np.ones((1, centers_m.shape[1]))))
        rows = self._rows(camera)
        seen = None if self._cells is None else self._cells.seen_from(camera.position_m)
        parts: list[FloatArray] = []
        stays = True
        for block, start in enumerate(self._starts):
            local_m = self._cull_block(start, rows, centers_m, seen)
            # Candidates often stay, and to compare masks takes less time than to gather anew.
            mask = self._keep[start : start + _BLOCK].tobytes()
            if mask != self._masks[block]:
                stays = False
                self._masks[block] = mask
                self._at[block] = self._keep[start : start + _BLOCK].nonzero()[0]
            parts.append(local_m[_PLANES:].take(self._at[block], axis=1))
        if not stays:
            at = [at + start for at, start in zip(self._at, self._starts, strict=True)]
            self._ids = np.concatenate(at, dtype=np.int32, casting="same_kind")
            self._ids.flags.writeable = False
        xyz_m = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)
        xyz_m.flags.writeable = False
        return self._ids, xyz_m

    def _cull_block(
        self, start: int, rows: FloatArray, centers_m: FloatArray, seen: BoolArray | None
    ) -> FloatArray:
        """Cull the nodes from `start` on; return what rows say of their centres, (8, size)."""
        keep = self._keep[start : start + _BLOCK]
        stop = start + len(keep)
        local_m, least_m = self._local_m[:, : len(keep)], self._least_m[: len(keep)]
        np.matmul(rows, centers_m[:, start:stop], out=local_m)
        np.minimum.reduce(local_m[:_PLANES], axis=0, out=least_m)
        np.greater_equal(least_m, self._behind_m[start:stop], out=keep)
        if seen is not None:
            np.logical_and(keep, seen[start:stop], out=keep)
        return local_m

    def _rows(self, camera: Camera) -> FloatArray:
        """Return the planes, and below them the camera's pose, as rows over (x, y, z, 1)."""
        lens = (camera.width_px, camera.height_px, camera.focal_px)
        if lens != self._lens:
            self._lens = lens
            self._normals = _normals(*lens)
        rows = np.matmul(self._normals, camera.pose)
        rows[_PLANES - 1, 3] -= camera.near_m
        return rows


def _normals(width_px: float, height_px: float, focal_px: float) -> FloatArray:
    """Return unit normals of the planes in the camera's frame, inwards, and its axes, (8, 3)."""
    normals = np.zeros((_PLANES + 3, 3))
    for axis, pixels in enumerate((width_px, height_px)):
        tangent = 0.5 * pixels / focal_px
        across = math.hypot(1.0, tangent)
        normals[2 * axis : 2 * axis + 2, axis] = 1.0 / across, -1.0 / across
        normals[2 * axis : 2 * axis + 2, 2] = tangent / across
    normals[_PLANES - 1, 2] = 1.0
    normals[_PLANES:] = np.eye(3)
    return normals
