"""Buffers and counts of one level of a surface mesh."""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..scene.levels import count_rows
from .geometry import LevelMesh
from .surface_mesh import SurfaceMesh


def level_mesh(level: SurfaceMesh) -> LevelMesh:
    """Return the buffers of a level: faces by part, a vertex for each position and coordinate."""
    order = np.argsort(level.part, kind="stable")
    positions, faces, uv_index = level.positions, level.faces[order], level.uv_index[order]
    pairs = np.stack((faces.ravel(), uv_index.ravel()), axis=1)
    vertex, index = np.unique(pairs, axis=0, return_inverse=True)
    start = np.searchsorted(level.part[order], np.arange(len(level.textured) + 1))
    return LevelMesh(
        positions[vertex[:, 0]].astype(np.float32),
        _normals(positions, faces)[vertex[:, 0]].astype(np.float32),
        index.reshape(-1, 3).astype(np.int32),
        start.astype(np.int32),
        level.uv[vertex[:, 1]].astype(np.float32) if level.has_uv else None,
    )


def level_counts(level: SurfaceMesh, mesh: LevelMesh) -> FloatArray:
    """Return the counts of a level in the order of `LEVEL_PREDICTORS`."""
    sizes = np.diff(mesh.part_start)
    return count_rows(
        1,
        draw_calls=np.count_nonzero(sizes),
        vertices=len(mesh.vertices),
        triangles=len(mesh.faces),
        textured_triangles=sizes[level.textured].sum(),
        texture_bytes=level.texture_bytes,
    )[0]


def _normals(positions: FloatArray, faces: IntArray) -> FloatArray:
    """Return unit normals of vertices, weighted by area; zero where the faces cancel."""
    a, b, c = (positions[faces[:, i]] for i in range(3))
    area = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    total = np.zeros_like(positions)
    np.add.at(total, faces.ravel(), area)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.divide(total, length, out=np.zeros_like(total), where=length > 0)
