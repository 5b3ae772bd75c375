"""A whole mesh simplified, with its materials and texture coordinates."""

from collections.abc import Sequence

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..meshes.attributes import carry
from ..meshes.simplify import simplify_surface
from ..meshes.surface_mesh import SurfaceMesh

_FEWEST = 4  # triangles that anything is simplified to


def simplify_whole(full: SurfaceMesh, factor: float) -> SurfaceMesh:
    """Return the mesh with its triangles divided by a factor, at least 1.

    Parts that share no vertex are simplified apart, each by the factor, so that each triangle keeps
    its material.  Otherwise the mesh is simplified as one, which opens no gap between its parts,
    and each triangle takes the material that lies nearest.
    """
    rows = [np.flatnonzero(full.part == part) for part in range(len(full.textured))]
    owners = np.concatenate([np.unique(full.faces[part]) for part in rows])
    if len(np.unique(owners)) < len(owners):
        return carry(full, *_simplified(full.positions, full.faces, factor))
    return carry(full, *_apart(full, rows, factor))


def _simplified(
    positions: FloatArray, faces: IntArray, factor: float
) -> tuple[FloatArray, IntArray]:
    return simplify_surface(positions, faces, max(round(len(faces) / factor), _FEWEST))


def _apart(
    full: SurfaceMesh, rows: Sequence[IntArray], factor: float
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return positions, faces and part of faces, simplified part by part."""
    positions: list[FloatArray] = []
    faces: list[IntArray] = []
    sizes: list[int] = []
    first = 0
    for own in rows:
        vertex, corner = np.unique(full.faces[own], return_inverse=True)
        points, coarse = _simplified(
            full.positions[vertex], corner.reshape(-1, 3).astype(np.int32), factor
        )
        positions.append(points)
        faces.append(coarse + first)
        sizes.append(len(coarse))
        first += len(points)
    part = np.repeat(np.arange(len(rows), dtype=np.int32), sizes)
    return np.concatenate(positions), np.concatenate(faces), part
