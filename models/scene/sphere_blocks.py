"""Spheres at rest in blocks of neighbours, so that a camera can pass by whole blocks."""

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray

_SIZE = 64  # spheres of a block; larger ones leave more to test, smaller ones are more to pass by
_FINE = 256  # cells along the longer side of the ground by which neighbours are found


class SphereBlocks:
    """S spheres of a scene in B blocks, each within a sphere of its own; arrays are read-only.

    The last block is filled up with its last sphere.

    Attributes
    ----------
    nodes : (B, size) intp
        Nodes of the scene, by block.
    points : (4, B, size) float64
        Their centres as columns (x, y, z, 1), metres.
    radius_m : (B, size) float64
    around : (4, B) float64
        Centres of the blocks' own spheres, as columns (x, y, z, 1), metres.
    around_m : (B,) float64
        Their radii, with a margin for the rounding of whoever compares distances with them.
    """

    def __init__(self, center_m: FloatArray, radius_m: FloatArray, nodes: IntArray) -> None:
        """Take all centres, (N, 3), all radii, (N,), and which nodes are to be in blocks, (S,)."""
        order = nodes[_by_neighbourhood(center_m[nodes], radius_m[nodes])]
        blocks = -(-len(order) // _SIZE)
        padded = np.pad(order, (0, blocks * _SIZE - len(order)), mode="edge" if blocks else "empty")
        self.nodes: NDArray[np.intp] = padded.reshape(blocks, _SIZE).astype(np.intp)
        centers_m = center_m[self.nodes]  # (B, size, 3)
        self.radius_m = radius_m[self.nodes]
        middle_m = 0.5 * (centers_m.min(axis=1) + centers_m.max(axis=1))
        gap_m = np.linalg.norm(centers_m - middle_m[:, np.newaxis], axis=2)
        self.points = np.ones((4, blocks, _SIZE))
        self.points[:3] = np.moveaxis(centers_m, 2, 0)
        self.around = np.ones((4, blocks))
        self.around[:3] = middle_m.T
        extent_m = float(np.abs(center_m).max(initial=0.0))
        self.around_m = (gap_m + self.radius_m).max(axis=1) * (1.0 + 1e-9) + 1e-9 * extent_m
        for array in (self.nodes, self.radius_m, self.points, self.around, self.around_m):
            array.flags.writeable = False

    def __len__(self) -> int:
        """Return the number of blocks."""
        return len(self.nodes)


def _by_neighbourhood(center_m: FloatArray, radius_m: FloatArray) -> NDArray[np.intp]:
    """Return an order of spheres in which neighbours on the ground stand together, (S,).

    By the bits of x and y in turn (Morton's curve).  Spheres that are larger than a block come
    after all others, by size: one among small ones would make a large block of theirs.
    """
    if len(center_m) == 0:
        return np.zeros(0, dtype=np.intp)
    low_m, side_m = center_m[:, :2].min(axis=0), np.ptp(center_m[:, :2], axis=0)
    longer_m = max(float(side_m.max()), 1e-300)
    cell = ((center_m[:, :2] - low_m) * ((_FINE - 1) / longer_m)).astype(np.uint16)
    curve = np.zeros(len(cell), dtype=np.uint16)
    for bit in range(8):
        for axis in (0, 1):
            curve |= ((cell[:, axis] >> bit) & 1) << (2 * bit + axis)
    block_m = math.sqrt(max(float(side_m.prod()), 1e-300) * _SIZE / len(center_m))
    size = np.ceil(np.log2(np.maximum(radius_m / block_m, 1.0))).astype(np.uint16)
    # Stable sorts of 16 bits take linear time.
    near = np.argsort(curve, kind="stable")
    return near[np.argsort(size[near], kind="stable")]
