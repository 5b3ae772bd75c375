"""Terrain as a quadtree of regular patches, each with its measured vertical error."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray, require_finite
from ...base.errors import InputError

SAMPLE_BYTES = 16.0
"""Height and normal of a vertex, float32; patches of one size share their indices."""


@dataclass(frozen=True, slots=True)
class TerrainQuadtree:
    """N patches of one grid size, breadth first from the root; children replace their parent.

    Attributes
    ----------
    patch : int
        Quads along a side of every patch.
    parent, depth : (N,) int32
        The root has parent -1 and depth 0; a patch at depth d takes every ``2^(d_max - d)``-th
        height.
    center_m, radius_m : (N, 3), (N,) float64
        Spheres about the box of all heights in a patch; x east, y north, z up.
    error_m : (N,) float64
        Greatest vertical distance of any height from the patch's triangles, and at least that of
        the patches below it; 0 at the leaves.
    """

    patch: int
    parent: IntArray
    depth: IntArray
    center_m: FloatArray
    radius_m: FloatArray
    error_m: FloatArray

    @property
    def triangles(self) -> int:
        """Triangles of each patch."""
        return 2 * self.patch**2

    @property
    def vertices(self) -> int:
        """Vertices of each patch."""
        return (self.patch + 1) ** 2

    @property
    def sent_vertices(self) -> int:
        """Vertices that are sent to draw a patch as triangle strips, one a row of quads.

        A vertex inside is sent twice, once for the row on either side; what joins the strips is not
        counted.
        """
        return 2 * self.patch * (self.patch + 1)


def build_terrain(height_m: FloatArray, cell_m: float, *, patch: int = 32) -> TerrainQuadtree:
    """Return the quadtree of a square field of heights, rows south to north.

    Raises `InputError` if the field has another shape, or a height is not finite.

    Parameters
    ----------
    height_m : (n, n), n = patch · 2^k + 1
    cell_m : distance of neighbouring heights, above 0
    patch : quads along a side of a patch, a power of two
    """
    side = len(height_m) - 1
    depths = int(np.log2(side // patch)) + 1 if patch > 0 and side >= patch else 0
    if height_m.shape != (side + 1, side + 1) or depths == 0 or patch << (depths - 1) != side:
        raise InputError(
            f"heights: expected a square of patch · 2^k + 1 rows, got shape {height_m.shape} for "
            f"patches of {patch}"
        )
    if patch & (patch - 1):
        raise InputError(f"patch: expected a power of two, got {patch}")
    if not (np.isfinite(cell_m) and cell_m > 0.0):
        raise InputError(f"cell_m: expected metres above 0, got {cell_m}")
    require_finite(height_m, "heights")
    layers = [_layer(height_m, cell_m, patch, depths - 1 - d) for d in range(depths)]
    errors = [layer[2] for layer in layers]
    # A policy that stops at a patch relies on no patch below it being worse.
    for above, below in zip(reversed(errors[:-1]), reversed(errors[1:]), strict=True):
        np.maximum(above, _greatest(below, 2), out=above)
    counts = [error.size for error in errors]
    # Breadth first: layers follow each other, each row by row.
    first = np.cumsum(counts) - counts
    parents = [np.array([-1])]
    for d in range(1, depths):
        row, column = np.indices(errors[d].shape) // 2
        parents.append((first[d - 1] + row * len(errors[d - 1]) + column).ravel())
    return TerrainQuadtree(
        patch,
        np.concatenate(parents).astype(np.int32),
        np.repeat(np.arange(depths, dtype=np.int32), counts),
        np.concatenate([layer[0] for layer in layers]),
        np.concatenate([layer[1] for layer in layers]),
        np.concatenate([error.ravel() for error in errors]),
    )


def _layer(
    height_m: FloatArray, cell_m: float, patch: int, height_in_tree: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return centres (n², 3), radii (n²,) and errors (n, n) of the patches at one depth."""
    step = 1 << height_in_tree
    span = patch * step
    # The least is the greatest of the negative heights.
    low, high = -_greatest(-height_m, span), _greatest(height_m, span)
    half = span * cell_m / 2.0
    middle = np.linspace(half, (2 * len(low) - 1) * half, len(low))
    x, y = np.meshgrid(middle, middle)
    center = np.stack((x, y, (low + high) / 2.0), axis=2).reshape(-1, 3)
    radius: FloatArray = np.sqrt(2.0 * half**2 + ((high - low) / 2.0) ** 2).ravel()
    return center, radius, _greatest(np.abs(height_m - _drawn_height(height_m, step)), span)


def _greatest(field: FloatArray, span: int) -> FloatArray:
    """Return the greatest value in each block; blocks share their borders where there are some."""
    n = len(field) // span
    blocks = field[: n * span, : n * span].reshape(n, span, n, span).max(axis=(1, 3))
    if len(field) == n * span:
        return blocks
    # Heights on a border belong to both blocks; the reshape above gave them to the later one.
    last = np.arange(1, n + 1) * span
    rows = field[last][:, : n * span].reshape(n, n, span).max(axis=2)
    columns = field[:, last][: n * span].reshape(n, span, n).max(axis=1)
    return np.maximum.reduce((blocks, rows, columns, field[np.ix_(last, last)]))


def _drawn_height(height_m: FloatArray, step: int) -> FloatArray:
    """Return the height of every `step`-th height's triangles at all heights.

    A quad is cut from its lower left to its upper right corner.
    """
    if step == 1:
        return height_m
    at = np.arange(len(height_m))
    # The last height lies on the far edge of the last quad, not in a quad of its own.
    cell = np.minimum(at // step, (len(height_m) - 1) // step - 1)
    part = (at - cell * step) / step
    coarse = height_m[::step, ::step]
    row, column = cell[:, None], cell[None, :]
    v, u = part[:, None], part[None, :]
    corner, opposite = coarse[row, column], coarse[row + 1, column + 1]
    east, north = coarse[row, column + 1], coarse[row + 1, column]
    # Both triangles have corner and opposite: the first goes by the east, the other by the north.
    lower = corner + u * (east - corner) + v * (opposite - east)
    upper = corner + v * (north - corner) + u * (opposite - north)
    return np.where(u >= v, lower, upper)
