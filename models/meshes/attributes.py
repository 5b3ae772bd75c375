"""Materials and texture coordinates carried from a full mesh to a simplified one."""

from dataclasses import replace

import numpy as np

from ...base.arrays import FloatArray, IntArray
from .mesh_error import nearest_faces
from .surface_mesh import SurfaceMesh


def carry(
    full: SurfaceMesh, positions: FloatArray, faces: IntArray, part: IntArray | None = None
) -> SurfaceMesh:
    """Return a simplified mesh with the texture coordinates, and the parts unless given, of it."""
    part = carry_parts(full, positions, faces) if part is None else part
    uv_index = carry_uv(full, positions, faces, part)
    return replace(full, positions=positions, faces=faces, part=part, uv_index=uv_index)


def carry_parts(full: SurfaceMesh, positions: FloatArray, faces: IntArray) -> IntArray:
    """Return the material part of each simplified face: that of the full face nearest to it."""
    if len(full.textured) == 1:
        return np.zeros(len(faces), dtype=np.int32)
    return full.part[nearest_faces(full.positions, full.faces, positions[faces].mean(axis=1))]


def carry_uv(full: SurfaceMesh, positions: FloatArray, faces: IntArray, part: IntArray) -> IntArray:
    """Return the texture coordinate index of each simplified corner, (F, 3).

    A corner takes a coordinate of the nearest full vertex of its part: where a seam gives that
    vertex several, the one on the corner's side.  Plain quadric collapse does not hold seams in
    place, so that coarse levels stretch a texture along them.
    """
    if not full.has_uv:
        return np.zeros(faces.shape, dtype=np.int32)
    result = np.empty(faces.shape, dtype=np.int32)
    for wanted in np.unique(part):
        rows = full.part == wanted
        mine = part == wanted
        chosen = _nearest_corners(full.positions, full.faces[rows], positions, faces[mine])
        result[mine] = full.uv_index[rows].ravel()[chosen].reshape(-1, 3)
    return result


def _nearest_corners(
    full_positions: FloatArray, full_faces: IntArray, positions: FloatArray, faces: IntArray
) -> IntArray:
    """Return for each corner the full corner at the nearest vertex that points the same way."""
    from scipy.spatial import KDTree

    order = np.argsort(full_faces, axis=None, kind="stable")
    vertex, start, count = np.unique(
        full_faces.ravel()[order], return_index=True, return_counts=True
    )
    near = np.asarray(KDTree(full_positions[vertex]).query(positions)[1])[faces.ravel()]
    # Every pair of a corner and a full corner at its nearest vertex, corner by corner.
    counts = count[near]
    first = np.cumsum(counts) - counts
    corner = np.repeat(np.arange(len(near)), counts)
    rival = order[np.arange(len(corner)) - first[corner] + start[near][corner]]
    toward = _inward(positions, faces)[corner]
    match = np.einsum("ij,ij->i", toward, _inward(full_positions, full_faces)[rival])
    best = np.lexsort((-match, corner))[first]
    return rival[best].astype(np.int32)


def _inward(positions: FloatArray, faces: IntArray) -> FloatArray:
    """Return unit vectors from each corner to its face's centroid, (3F, 3)."""
    corners = positions[faces]
    inward = (corners.mean(axis=1, keepdims=True) - corners).reshape(-1, 3)
    length = np.linalg.norm(inward, axis=1, keepdims=True)
    return np.divide(inward, length, out=np.zeros_like(inward), where=length > 0)
