"""Frustum culling of bounding spheres: whole blocks of neighbours first, then what is left."""

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, IntArray
from .camera import Camera
from .cells import Cells
from .motion import Centers, Placed
from .sphere_blocks import SphereBlocks

_PLANES = 5  # left, right, bottom, top and near
_TOGETHER = 8_000  # spheres whose buffers fit a core's cache; BLAS starts no threads for so few
_NOWHERE = np.zeros(0, dtype=np.intp)
_X_THEN_Y = np.array([[0], [1]])


class Culler:
    """Culls the spheres of N nodes against one camera after another.

    `inside`, (N,) bool and read-only, holds the last answer as a mask; the next cull overwrites it.
    `at`, (m,) intp and read-only, are its candidates as numpy indexes fastest.

    A sphere is a candidate unless it lies wholly outside one of the four side planes or the near
    plane; there is no far plane.  This keeps some spheres that only meet the planes' extensions,
    as engines' sphere tests do, and never drops one that is in view.  With `cells`, what walls hide
    is dropped too.

    Nodes at rest stand in blocks.  Where a block lies wholly inside or outside its nodes do; only
    those of the other blocks, and those that move, are tested one by one.
    """

    def __init__(
        self,
        centers: Centers,
        radius_m: FloatArray,
        blocks: SphereBlocks,
        cells: Cells | None = None,
    ) -> None:
        """Take where the nodes are, their radii, (N,), and blocks of those that never move."""
        n = len(radius_m)
        self._centers, self._blocks, self._cells = centers, blocks, cells
        self._lens: tuple[float, ...] = ()
        self._normals = np.zeros((_PLANES, 3))
        self._in_frustum = np.zeros(n, dtype=np.bool_)
        self._inside = self._in_frustum if cells is None else np.zeros(n, dtype=np.bool_)
        self.inside = self._inside.view()
        self.inside.flags.writeable = False
        self._seen: BoolArray | None = None
        # Of each node that moves, which of them it is; -1 of the others.
        self._rank = np.full(n, -1, dtype=np.intp)
        self._rank[centers.moving] = np.arange(len(centers.moving))
        # Blocks, 0 outside, 1 between and 2 inside; and what is tested in a frame: all blocks,
        # nodes of those between, and nodes that move.  Of these, how far behind a plane the centres
        # may be, and the last answers.
        self._state = np.zeros(len(blocks), dtype=np.uint8)
        self._moving_m = centers.rest_m.take(centers.moving, axis=1)
        self._moving_radius_m = radius_m.take(centers.moving)
        self._take_blocks()
        self._answer = b"", b""
        # The candidates, their centres, and where among these are x and y of which moving ones.
        self.at = _NOWHERE
        self._ids: IntArray = np.zeros(0, dtype=np.int32)
        self._points = np.zeros((4, 0))
        self._moved_at = self._moved = _NOWHERE

    def cull(self, now: Placed, camera: Camera) -> tuple[IntArray, FloatArray]:
        """Return ids of candidates, ascending, and their (3, m) camera coordinates; read-only.

        Where the candidates are those of the cull before, the ids are the same array.
        """
        changes = self._test(self._planes(camera), now)
        if self._cells is not None:
            seen = self._cells.seen_from(camera.position_m)
            if changes or seen is not self._seen:
                changes, self._seen = True, seen
                np.logical_and(self._in_frustum, seen, out=self._inside)
        if changes:
            self._gather()
        if len(self._moved):
            moved_m = now.moved_m.reshape(-1).take(self._moved)
            self._points.reshape(-1)[self._moved_at] = moved_m
        return self._ids, camera.place(self._points)

    def _test(self, planes: FloatArray, now: Placed) -> bool:
        """Find what is in the frustum; return whether any has changed, or may have."""
        blocks = len(self._blocks)
        least_m = self._measure(planes, now)
        reaches = least_m >= self._behind_m
        within = least_m[:blocks] >= self._blocks.around_m
        # Candidates often stay, and to compare bytes takes less time than to gather anew.
        answer = reaches.tobytes(), within.tobytes()
        if answer == self._answer:
            return False
        state = reaches[:blocks].view(np.uint8) + within.view(np.uint8)
        if (state != self._state).any():
            self._change_blocks(state)
            reaches = self._measure(planes, now) >= self._behind_m
            answer = reaches.tobytes(), answer[1]
        self._answer = answer
        # Few nodes come or go, and to find them takes less time than to write all.
        now_in = reaches[blocks:]
        changed = (now_in != self._in_frustum.take(self._nodes)).nonzero()[0]
        self._in_frustum[self._nodes.take(changed)] = now_in.take(changed)
        return True

    def _measure(self, planes: FloatArray, now: Placed) -> FloatArray:
        """Return how far inside the planes the centres of what is tested are at least."""
        moving = now.moved_m.shape[1]
        if moving:
            self._tested[:2, -moving:] = now.moved_m
        return _least_m(planes, self._tested)

    def _gather(self) -> None:
        """Gather the candidates, unless they are those of the cull before."""
        at = self._inside.nonzero()[0]
        if at.tobytes() == self.at.tobytes():
            return
        self.at, self._ids = at, at.astype(np.int32)
        at.setflags(write=False)
        self._ids.setflags(write=False)
        self._points = np.empty((4, len(at)))
        self._points[3] = 1.0
        # A mode that never raises lets numpy write where it is told to, without a copy between.
        self._centers.rest_m[:3].take(at, axis=1, out=self._points[:3], mode="clip")
        if len(self._centers.moving):
            rank = self._rank.take(at)
            column = (rank >= 0).nonzero()[0]
            rank = rank.take(column)
            # Positions of x, then of y, in all coordinates one row after the other.
            self._moved_at = (_X_THEN_Y * len(at) + column).reshape(-1)
            self._moved = (_X_THEN_Y * len(self._centers.moving) + rank).reshape(-1)

    def _change_blocks(self, state: NDArray[np.uint8]) -> None:
        """Go over to other states of the blocks."""
        changed = state != self._state
        self._state = state
        for whole in (0, 2):
            at = (changed & (state == whole)).nonzero()[0]
            self._in_frustum[self._blocks.nodes.take(at, axis=0)] = whole == 2
        self._take_blocks()

    def _take_blocks(self) -> None:
        """Gather what is tested: all blocks, nodes of those between, and nodes that move."""
        blocks, at = self._blocks, (self._state == 1).nonzero()[0]
        nodes = blocks.nodes[at].reshape(-1)
        points = blocks.points[:, at].reshape(4, -1)
        radius_m = blocks.radius_m[at].reshape(-1)
        self._nodes = np.concatenate((nodes, self._centers.moving))
        self._tested = np.concatenate((blocks.around, points, self._moving_m), axis=1)
        self._behind_m = -np.concatenate((blocks.around_m, radius_m, self._moving_radius_m))

    def _planes(self, camera: Camera) -> FloatArray:
        """Return the planes as rows over (x, y, z, 1), inwards."""
        lens = (camera.width_px, camera.height_px, camera.focal_px)
        if lens != self._lens:
            self._lens = lens
            self._normals = _normals(*lens)
        planes = np.matmul(self._normals, camera.pose)
        planes[_PLANES - 1, 3] -= camera.near_m
        return planes


def _least_m(planes: FloatArray, points: FloatArray) -> FloatArray:
    """Return how far inside the planes points (x, y, z, 1) are at least, (n,) of (4, n)."""
    n = points.shape[1]
    if n <= _TOGETHER:
        return np.minimum.reduce(np.matmul(planes, points), axis=0)
    least_m, inwards_m = np.empty(n), np.empty((len(planes), _TOGETHER))
    for start in range(0, n, _TOGETHER):
        part = points[:, start : start + _TOGETHER]
        some_m = np.matmul(planes, part, out=inwards_m[:, : part.shape[1]])
        np.minimum.reduce(some_m, axis=0, out=least_m[start : start + _TOGETHER])
    return least_m


def _normals(width_px: float, height_px: float, focal_px: float) -> FloatArray:
    """Return unit normals of the planes in the camera's frame, inwards, (5, 3)."""
    normals = np.zeros((_PLANES, 3))
    for axis, pixels in enumerate((width_px, height_px)):
        tangent = 0.5 * pixels / focal_px
        across = math.hypot(1.0, tangent)
        normals[2 * axis : 2 * axis + 2, axis] = 1.0 / across, -1.0 / across
        normals[2 * axis : 2 * axis + 2, 2] = tangent / across
    normals[_PLANES - 1, 2] = 1.0
    return normals
