"""Cutting a mesh along planes, so that no triangle crosses one and no vertex meets an edge.

New vertices are made once for each edge and shared by all triangles about it, on whichever side
and in whichever cell, so that pieces fit to the last bit.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ..meshes.surface_mesh import SurfaceMesh

_ON_PLANE = 1e-9  # of the mesh's size: nearer is on the plane


@dataclass(frozen=True, slots=True)
class Planes:
    """Planes perpendicular to an axis, by cell.

    Attributes
    ----------
    axis : (C,) int
        0 to 2.
    offset_m : (C, J) float64
        Rising along a row.
    """

    axis: IntArray
    offset_m: FloatArray


def cut_along(mesh: SurfaceMesh, cell: IntArray, planes: Planes) -> tuple[SurfaceMesh, IntArray]:
    """Return the mesh with each triangle cut along the planes of its cell, and cells of triangles.

    The surface stays what it is: only triangles that a plane crosses, and their neighbours along a
    crossed edge, are divided.

    Parameters
    ----------
    cell : (F,) row of `planes` of each triangle
    """
    size = float(np.ptp(mesh.positions, axis=0).max())
    for column in range(planes.offset_m.shape[1]):
        # Where two cells meet, an edge may cross a plane of each: one is cut in a pass.
        while True:
            edges = _crossed_edges(mesh, cell, planes, column, _ON_PLANE * size)
            if len(edges.vertices) == 0:
                break
            mesh, cell = _split(mesh, cell, edges)
    return mesh, cell


@dataclass(frozen=True, slots=True)
class _Edges:
    """Edges to cut: vertices (e, 2) with the lower one first, by rising key, and where."""

    vertices: IntArray
    axis: IntArray
    offset_m: FloatArray


def _crossed_edges(
    mesh: SurfaceMesh, cell: IntArray, planes: Planes, column: int, tolerance_m: float
) -> _Edges:
    axis, offset = planes.axis[cell], planes.offset_m[cell, column]
    side = mesh.positions[mesh.faces, axis[:, None]] - offset[:, None]
    side[np.abs(side) <= tolerance_m] = 0.0
    crossed = (side * np.roll(side, -1, axis=1) < 0.0).ravel()
    ends = np.stack((mesh.faces, np.roll(mesh.faces, -1, axis=1)), axis=2).reshape(-1, 2)[crossed]
    ends = np.sort(ends, axis=1)
    _, first = np.unique(_key(ends, len(mesh.positions)), return_index=True)
    return _Edges(
        ends[first], np.repeat(axis, 3)[crossed][first], np.repeat(offset, 3)[crossed][first]
    )


def _key(ends: IntArray, vertices: int) -> NDArray[np.int64]:
    key: NDArray[np.int64] = ends[..., 0].astype(np.int64) * vertices + ends[..., 1]
    return key


def _split(mesh: SurfaceMesh, cell: IntArray, edges: _Edges) -> tuple[SurfaceMesh, IntArray]:
    """Return the mesh with a vertex on each of the edges, and its triangles divided to fit."""
    low, high = mesh.positions[edges.vertices[:, 0]], mesh.positions[edges.vertices[:, 1]]
    rows = np.arange(len(low))
    start, end = low[rows, edges.axis], high[rows, edges.axis]
    share = (edges.offset_m - start) / (end - start)
    points = low + share[:, None] * (high - low)
    points[rows, edges.axis] = edges.offset_m
    which = _edge_of_corners(mesh, edges)
    count = (which >= 0).sum(axis=1)
    at = np.flatnonzero(count)
    turned = _turn(which[at], count[at])
    rolled = (np.arange(3) + turned[:, None]) % 3
    which = np.take_along_axis(which[at], rolled, axis=1)
    corner = np.take_along_axis(mesh.faces[at], rolled, axis=1)
    uv_corner = np.take_along_axis(mesh.uv_index[at], rolled, axis=1)
    uv, middle_uv = _cut_uv(mesh, corner, uv_corner, which, share)
    middle = which + len(mesh.positions)
    faces, uv_index = _divide(corner, middle, count[at]), _divide(uv_corner, middle_uv, count[at])
    untouched = count == 0
    again = np.concatenate((at, at, at[count[at] >= 2], at[count[at] == 3]))
    cut = replace(
        mesh,
        positions=np.concatenate((mesh.positions, points)),
        faces=np.concatenate((mesh.faces[untouched], faces)),
        part=np.concatenate((mesh.part[untouched], mesh.part[again])),
        uv=uv,
        uv_index=np.concatenate((mesh.uv_index[untouched], uv_index)),
    )
    return cut, np.concatenate((cell[untouched], cell[again]))


def _edge_of_corners(mesh: SurfaceMesh, edges: _Edges) -> IntArray:
    """Return for each side of each triangle, from corner i to the next, its cut edge or -1."""
    sides = np.sort(np.stack((mesh.faces, np.roll(mesh.faces, -1, axis=1)), axis=2), axis=2)
    keys = _key(edges.vertices, len(mesh.positions))
    mine = _key(sides, len(mesh.positions))
    row = np.minimum(np.searchsorted(keys, mine), len(keys) - 1)
    edge: NDArray[np.int64] = np.where(keys[row] == mine, row, -1)
    return edge


def _turn(which: IntArray, count: IntArray) -> IntArray:
    """Return by how many corners to turn triangles: one cut side first, or two: last and first."""
    first = (which >= 0).argmax(axis=1)
    whole = (which < 0).argmax(axis=1)
    return np.where(count == 1, first, np.where(count == 2, (whole + 2) % 3, 0))


def _divide(corner: IntArray, middle: IntArray, count: IntArray) -> NDArray[np.int64]:
    """Return the parts of triangles a b c: one more than the sides that are cut.

    One: side ab, at m.  Two: ab and ca, at m and n, so that a lies alone.  Three (cells of two
    neighbours cut a side each): at m, k and n.
    """
    a, b, c = (corner[:, i].astype(np.int64) for i in range(3))
    m, k, n = (middle[:, i].astype(np.int64) for i in range(3))
    two, three = count >= 2, count == 3
    beside_a: NDArray[np.int64] = np.where(two, n, c)
    beside_c: NDArray[np.int64] = np.where(three, k, c)
    parts = (
        np.stack((a, m, beside_a), axis=1),
        np.stack((m, b, beside_c), axis=1),
        np.stack((m, beside_c, n), axis=1)[two],
        np.stack((n, k, c), axis=1)[three],
    )
    return np.concatenate(parts)


def _cut_uv(
    mesh: SurfaceMesh, corner: IntArray, uv_corner: IntArray, which: IntArray, share: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Return all texture coordinates, and the one on each cut side of each triangle."""
    if not mesh.has_uv:
        return mesh.uv, np.zeros_like(which)
    row, side = np.nonzero(which >= 0)
    after = (side + 1) % 3
    # From the lower vertex up, so that both triangles about an edge get the same number.
    forward = corner[row, side] < corner[row, after]
    low = uv_corner[row, np.where(forward, side, after)]
    high = uv_corner[row, np.where(forward, after, side)]
    at = share[which[row, side]][:, None]
    new = mesh.uv[low] + at * (mesh.uv[high] - mesh.uv[low])
    unique, index = np.unique(np.concatenate((mesh.uv, new)), axis=0, return_inverse=True)
    # Old rows keep their numbers: new ones come behind, found again if they are equal to old ones.
    place = np.full(len(unique), -1)
    old = len(mesh.uv)
    index = index.ravel()
    place[index[:old]] = np.arange(old)
    fresh = np.flatnonzero(place < 0)
    place[fresh] = old + np.arange(len(fresh))
    middle_uv = np.zeros_like(which)
    middle_uv[row, side] = place[index[old:]]
    return np.concatenate((mesh.uv, unique[fresh])), middle_uv
