"""Error of a texture on a simplified mesh, measured in texture space."""

from typing import Any

import numpy as np

from lodbench.base.arrays import FloatArray, IntArray
from lodbench.models.meshes.surface_mesh import SurfaceMesh


class TextureMeter:
    """Distance in texture space between the texture of a full mesh and that of its levels.

    Points are drawn uniformly by area on the textured triangles of each of the two surfaces; each
    is compared with the nearest point of the other surface's textured triangles.
    """

    def __init__(self, full: SurfaceMesh, *, points: int = 10_000, seed: int = 0) -> None:
        self._full, self._points, self._seed = full, points, seed
        # trimesh needs edges well above 1e-3 (see `mesh_error`).
        self._low = full.positions.min(axis=0)
        self._scale = 1000.0 / float(np.ptp(full.positions, axis=0).max())
        self._surface = self._textured(full.positions, full.faces, full.part, full.uv_index)

    def error_uv(
        self, positions: FloatArray, faces: IntArray, part: IntArray, uv_index: IntArray
    ) -> float:
        """Return the mean distance, both ways, in texture coordinates; 1 is a whole image."""
        level = self._textured(positions, faces, part, uv_index)
        there = self._distance(self._surface, level)
        back = self._distance(level, self._surface)
        return float((there.mean() + back.mean()) / 2.0)

    def _textured(
        self, positions: FloatArray, faces: IntArray, part: IntArray, uv_index: IntArray
    ) -> tuple[Any, FloatArray]:
        """Return a mesh of the textured triangles, and the coordinates of their corners."""
        import trimesh

        rows = self._full.textured[part]
        points = (positions - self._low) * self._scale
        mesh: Any = trimesh.Trimesh(points, faces[rows], process=False)
        return mesh, self._full.uv[uv_index[rows]]

    def _distance(
        self, source: tuple[Any, FloatArray], other: tuple[Any, FloatArray]
    ) -> FloatArray:
        import trimesh

        sampler: Any = trimesh.sample
        # The same seed for every level: errors of levels differ by the levels, not by the points.
        drawn = sampler.sample_surface(source[0], self._points, seed=self._seed)
        points, face = np.asarray(drawn[0], dtype=np.float64), np.asarray(drawn[1])
        nearest, _, hit = trimesh.proximity.closest_point(other[0], points)
        mine = _at(source, face, points)
        return np.linalg.norm(mine - _at(other, np.asarray(hit), np.asarray(nearest)), axis=1)


def _at(textured: tuple[Any, FloatArray], face: IntArray, points: FloatArray) -> FloatArray:
    """Return the texture coordinates of points that lie on the given triangles, (n, 2)."""
    import trimesh

    mesh, uv = textured
    triangles = np.asarray(mesh.triangles, dtype=np.float64)[face]
    weights: Any = trimesh.triangles.points_to_barycentric(triangles, points)
    return np.einsum("ni,nij->nj", np.asarray(weights, dtype=np.float64), uv[face])
