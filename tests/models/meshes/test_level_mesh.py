"""Buffers and counts of a level, on two triangles by hand."""

import numpy as np

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.meshes.level_mesh import level_counts, level_mesh
from lodbench.models.meshes.surface_mesh import MeshPart, clean_surface


def test_a_seam_doubles_vertices() -> None:
    """A square of two triangles, one textured, with one corner on a seam: 5 vertices, 2 parts."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    uv = points[:, :2]
    moved = uv.copy()
    moved[2] = (0.0, 0.5)
    parts = [
        MeshPart(points, np.array([[0, 1, 2]]), 0, textured=True, uv=uv),
        MeshPart(points, np.array([[0, 2, 3]]), 1, textured=False, uv=moved),
    ]
    surface = clean_surface("square", parts, texture_bytes=64.0)
    mesh = level_mesh(surface)
    counts = dict(zip(LEVEL_PREDICTORS, level_counts(surface, mesh).tolist(), strict=True))
    assert counts["vertices"] == 5.0
    assert counts["draw_calls"] == counts["triangles"] == 2.0
    assert counts["textured_triangles"] == 1.0
    assert counts["texture_bytes"] == 64.0
    assert mesh.normals.tolist() == [[0.0, 0.0, 1.0]] * 5
    assert mesh.part_start.tolist() == [0, 1, 2]
