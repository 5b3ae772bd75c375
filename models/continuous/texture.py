"""Collapse that keeps a texture where it is: drawn vertices, their classes, and the order."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ..meshes.surface_mesh import SurfaceMesh
from .collapse import Contraction, contract


@dataclass(frozen=True, slots=True)
class DrawnVertices:
    """The W vertices of a vertex buffer: a position for each coordinate and material it has there.

    Attributes
    ----------
    corner : (F, 3) int32
        Drawn vertex of each corner.
    position, part, uv_index : (W,) int32
    """

    corner: IntArray
    position: IntArray
    part: IntArray
    uv_index: IntArray

    @classmethod
    def of(cls, mesh: SurfaceMesh) -> "DrawnVertices":
        """Split the positions of a mesh by texture coordinate and material (Peng, section 4.1)."""
        part = np.repeat(mesh.part, 3)
        keys = np.stack((mesh.faces.ravel(), part, mesh.uv_index.ravel()), axis=1)
        rows, corner = np.unique(keys, axis=0, return_inverse=True)
        return cls(corner.reshape(-1, 3).astype(np.int32), *rows.T.astype(np.int32))


def fixed_positions(mesh: SurfaceMesh, drawn: DrawnVertices) -> BoolArray:
    """Return which positions never move, (V,).

    These are positions on a border of the surface and those of three or more drawn vertices.  Of
    the others, those of two are companioned, and those of one are regular.

    Source: Peng, Park and Cao, "A real-time system of crowd rendering: parallel LOD and
    texture-preserving approach on GPU" (2011), section 4.2.
    """
    split = np.bincount(drawn.position, minlength=len(mesh.positions))
    edges = np.stack((mesh.faces, np.roll(mesh.faces, -1, axis=1)), axis=2).reshape(-1, 2)
    # An edge of one triangle is a border.
    pairs, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    border = np.zeros(len(mesh.positions), dtype=np.bool_)
    border[pairs[count == 1]] = True
    return border | (split > 2)


def contract_textured(
    mesh: SurfaceMesh, poses: FloatArray | None = None
) -> tuple[DrawnVertices, Contraction]:
    """Return the drawn vertices of a mesh and the collapses of them that keep its texture.

    A regular vertex may move along any edge.  A companioned one moves along a seam, with its
    companion, each to the drawn vertex at the end of its own side's edge, so that the edge is one
    both in the world and in the texture.  The cost is the mean over `poses`, (P, V, 3), of an
    animation; else that of the mesh as it stands.
    """
    drawn = DrawnVertices.of(mesh)
    fixed = fixed_positions(mesh, drawn)
    shapes = mesh.positions[None] if poses is None else poses
    return drawn, contract(shapes, mesh.faces, drawn=drawn.corner, fixed=fixed)
