"""The cells of a hierarchy: who is whose part, and how a mesh is divided among them."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..meshes.surface_mesh import SurfaceMesh
from .cut import Planes, cut_along


@dataclass(frozen=True, slots=True)
class CellTree:
    """Cells by depth; depth 0 has one cell, and planes of a depth lead to the next.

    Attributes
    ----------
    planes : one for each depth but the last
    child : (C, factor) int for each depth but the last
        Row, in the next depth, of the cell in each slot between planes.  A slot in which the full
        mesh has nothing leads to the nearest slot that has.
    parent : (C,) int for each depth
    """

    planes: list[Planes]
    child: list[IntArray]
    parent: list[IntArray]

    def divide(self, mesh: SurfaceMesh, depth: int, finer: list[SurfaceMesh]) -> list[SurfaceMesh]:
        """Return the piece of a mesh in each cell of a depth.

        `finer` has the pieces of the next depth, which stand in where nothing is left.
        """
        cell = np.zeros(len(mesh.faces), dtype=np.int64)
        for above in range(depth):
            mesh, cell = cut_along(mesh, cell, self.planes[above])
            slot = _slots(mesh, cell, self.planes[above])
            cell = self.child[above][cell, slot]
        pieces = _split_up(mesh, cell, len(self.parent[depth]))
        below = self.parent[depth + 1]
        return [
            piece or _joined([finer[i] for i in np.flatnonzero(below == row)])
            for row, piece in enumerate(pieces)
        ]


def grow_cells(full: SurfaceMesh, factor: int, levels: int) -> tuple[CellTree, list[SurfaceMesh]]:
    """Return cells of a mesh, and its pieces in the last depth.

    A cell is divided into `factor` parts of equal length by planes perpendicular to the longest
    side of the box about what is in it.
    """
    tree = CellTree([], [], [np.array([-1])])
    mesh, cell = full, np.zeros(len(full.faces), dtype=np.int64)
    for _ in range(levels - 1):
        planes = _planes(mesh, cell, len(tree.parent[-1]), factor)
        mesh, cell = cut_along(mesh, cell, planes)
        slot = _slots(mesh, cell, planes)
        used, row = np.unique(cell * factor + slot, return_inverse=True)
        tree.planes.append(planes)
        tree.child.append(_children(used, len(tree.parent[-1]), factor))
        tree.parent.append(used // factor)
        cell = row.ravel()
    pieces = _split_up(mesh, cell, len(tree.parent[-1]))
    return tree, [piece for piece in pieces if piece is not None]


def _planes(mesh: SurfaceMesh, cell: IntArray, cells: int, factor: int) -> Planes:
    low = np.full((cells, 3), np.inf)
    high = np.full((cells, 3), -np.inf)
    corners = mesh.positions[mesh.faces]
    np.minimum.at(low, cell, corners.min(axis=1))
    np.maximum.at(high, cell, corners.max(axis=1))
    axis = (high - low).argmax(axis=1)
    rows = np.arange(cells)
    start, end = low[rows, axis], high[rows, axis]
    part = np.arange(1, factor) / factor
    return Planes(axis, start[:, None] + part * (end - start)[:, None])


def _slots(mesh: SurfaceMesh, cell: IntArray, planes: Planes) -> IntArray:
    """Return between which planes of its cell each triangle lies, (F,)."""
    middle = mesh.positions[mesh.faces].mean(axis=1)
    along = np.take_along_axis(middle, planes.axis[cell][:, None], axis=1)
    return (along > planes.offset_m[cell]).sum(axis=1)


def _children(used: IntArray, cells: int, factor: int) -> IntArray:
    """Return the row of the cell that each slot leads to, (cells, factor)."""
    parent, slot = np.divmod(used, factor)
    gap = np.abs(np.arange(factor)[None, :] - slot[:, None]).astype(np.float64)
    child = np.zeros((cells, factor), dtype=np.int64)
    nearest = np.full((cells, factor), np.inf)
    for row in range(len(used)):
        better = gap[row] < nearest[parent[row]]
        child[parent[row], better] = row
        nearest[parent[row], better] = gap[row, better]
    return child


def _split_up(mesh: SurfaceMesh, cell: IntArray, cells: int) -> list[SurfaceMesh | None]:
    """Return the triangles of each cell as a mesh of their own, None where there are none."""
    order = np.argsort(cell, kind="stable")
    bounds = np.searchsorted(cell[order], np.arange(cells + 1))
    return [_piece(mesh, order[a:b]) if b > a else None for a, b in pairwise(bounds.tolist())]


def _piece(mesh: SurfaceMesh, rows: IntArray) -> SurfaceMesh:
    vertex, corner = np.unique(mesh.faces[rows], return_inverse=True)
    uv, uv_corner = mesh.uv, mesh.uv_index[rows]
    if mesh.has_uv:
        used, index = np.unique(uv_corner, return_inverse=True)
        # One row would mean a mesh without texture coordinates.
        uv = mesh.uv[used] if len(used) > 1 else np.repeat(mesh.uv[used], 2, axis=0)
        uv_corner = index.reshape(-1, 3)
    return replace(
        mesh,
        positions=mesh.positions[vertex],
        faces=corner.reshape(-1, 3),
        part=mesh.part[rows],
        uv=uv,
        uv_index=uv_corner,
    )


def _joined(pieces: list[SurfaceMesh]) -> SurfaceMesh:
    """Return several pieces as one."""
    vertices: FloatArray = np.concatenate([piece.positions for piece in pieces])
    first = np.cumsum([0, *(len(piece.positions) for piece in pieces)])
    first_uv = np.cumsum([0, *(len(piece.uv) for piece in pieces)])
    has_uv = pieces[0].has_uv
    return replace(
        pieces[0],
        positions=vertices,
        faces=np.concatenate([p.faces + f for p, f in zip(pieces, first[:-1], strict=True)]),
        part=np.concatenate([piece.part for piece in pieces]),
        uv=np.concatenate([piece.uv for piece in pieces]) if has_uv else pieces[0].uv,
        uv_index=np.concatenate(
            [p.uv_index + f * has_uv for p, f in zip(pieces, first_uv[:-1], strict=True)]
        ),
    )
