"""Triangles to pixels, nearest first: a z-buffer over vectorised blocks of equal size."""

import numpy as np

from ...base.arrays import FloatArray, IntArray

_CHUNK = 4_000_000  # candidate pixels at once
_TILE = 32  # pixels along a side of the largest block; larger triangles are drawn in tiles
_NEAR = 1e-6


class Canvas:
    """Colours and depths of width by height pixels.

    Attributes
    ----------
    color : (height, width, 3) float32, 0 to 1
    depth : (height, width) float32
        Distance along the view axis; infinite where nothing is drawn.
    """

    def __init__(self, background: FloatArray) -> None:
        self._height, self._width = len(background), background.shape[1]
        self.color = background.astype(np.float32)
        self.depth = np.full((self._height, self._width), np.inf, dtype=np.float32)

    def draw(self, corners: FloatArray, color: FloatArray) -> None:
        """Draw triangles, flat in colour.

        Parameters
        ----------
        corners : (n, 3, 3)
            Pixel x, pixel y and depth of each corner; depths above 0.
        color : (n, 3)
        """
        height, width = self._height, self._width
        low = np.floor(corners[:, :, :2].min(axis=1))
        high = np.ceil(corners[:, :, :2].max(axis=1))
        shown = (high > 0.0).all(axis=1) & (low < (width, height)).all(axis=1)
        corners, color = corners[shown], color[shown]
        low = np.maximum(low[shown], 0.0).astype(np.int64)
        high = np.minimum(high[shown], (width, height)).astype(np.int64)
        span = (high - low).max(axis=1)
        side = 1 << np.ceil(np.log2(np.maximum(span, 1))).astype(np.int64)
        large = np.flatnonzero(side > _TILE)
        self._draw_blocks(*_tiles(corners, color, low, high, large), _TILE)
        for size in np.unique(side[side <= _TILE]).tolist():
            rows = np.flatnonzero(side == size)
            self._draw_blocks(corners[rows], color[rows], low[rows], int(size))

    def _draw_blocks(
        self, corners: FloatArray, color: FloatArray, low: IntArray, size: int
    ) -> None:
        step = max(1, _CHUNK // (size * size))
        for start in range(0, len(corners), step):
            part = slice(start, start + step)
            self._draw_block(corners[part], color[part], low[part], size)

    def _draw_block(self, corners: FloatArray, color: FloatArray, low: IntArray, size: int) -> None:
        """Draw what of the triangles lies in squares of size by size pixels that begin at `low`."""
        dy, dx = (a.ravel() for a in np.mgrid[0:size, 0:size])
        x, y = low[:, :1] + dx, low[:, 1:] + dy
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
            (corners[:, i, 0:1], corners[:, i, 1:2], corners[:, i, 2:3]) for i in range(3)
        )
        px, py = x + 0.5, y + 0.5
        double = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        flat = np.abs(double) < 1e-12
        scale = 1.0 / np.where(flat, 1.0, double)
        u = ((bx - px) * (cy - py) - (cx - px) * (by - py)) * scale
        v = ((cx - px) * (ay - py) - (ax - px) * (cy - py)) * scale
        w = 1.0 - u - v
        inside = (u >= 0.0) & (v >= 0.0) & (w >= 0.0) & ~flat
        if size <= 2:  # smaller than the gaps between pixel centres: at least one pixel
            inside[~inside.any(axis=1), 0] = True
        # Depth is linear in the picture in its reciprocal.
        near = np.minimum(np.minimum(az, bz), cz)
        far = np.maximum(np.maximum(az, bz), cz)
        depth = 1.0 / np.maximum(u / az + v / bz + w / cz, _NEAR / far)
        depth = np.clip(depth, near, far)
        height, width = self._height, self._width
        row, column = np.nonzero(inside & (x < width) & (y < height))
        self._put(y[row, column] * width + x[row, column], depth[row, column], color[row])

    def _put(self, pixel: IntArray, depth: FloatArray, color: FloatArray) -> None:
        """Put fragments that are nearer than what is there."""
        flat_depth, flat_color = self.depth.reshape(-1), self.color.reshape(-1, 3)
        nearer = depth < flat_depth[pixel]
        pixel, depth, color = pixel[nearer], depth[nearer], color[nearer]
        order = np.lexsort((depth, pixel))
        first = order[np.flatnonzero(np.diff(pixel[order], prepend=-1))]
        flat_depth[pixel[first]] = depth[first]
        flat_color[pixel[first]] = color[first]


def _tiles(
    corners: FloatArray, color: FloatArray, low: IntArray, high: IntArray, rows: IntArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return large triangles once for each tile that they may touch, with where it begins."""
    count = -(-(high[rows] - low[rows]) // _TILE)
    number = count.prod(axis=1)
    owner = np.repeat(np.arange(len(rows)), number)
    place = np.arange(int(number.sum())) - np.repeat(np.cumsum(number) - number, number)
    tile = np.stack((place % count[owner, 0], place // count[owner, 0]), axis=1)
    start = low[rows][owner] + _TILE * tile
    triangle = corners[rows][owner]
    touched = np.ones(len(owner), dtype=np.bool_)
    ends = triangle[:, :, :2]
    edge = np.roll(ends, -1, axis=1) - ends
    winding = np.sign(edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0])
    for i in range(3):
        # The corner of the tile that lies farthest inside of this edge.
        normal = winding[:, None] * np.stack((-edge[:, i, 1], edge[:, i, 0]), axis=1)
        farthest = start + _TILE * (normal > 0.0)
        touched &= ((farthest - ends[:, i]) * normal).sum(axis=1) >= 0.0
    return triangle[touched], color[rows][owner][touched], start[touched]
