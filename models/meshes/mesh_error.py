"""Geometric error of a simplified mesh, measured on the surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ...base.arrays import FloatArray, IntArray

_CANDIDATES = 1_000_000  # pairs of a point and a face in one query, some hundred bytes each


@dataclass(frozen=True, slots=True)
class Sampling:
    """Where distances are measured, on each of the two surfaces.

    Attributes
    ----------
    vertices : int
        Vertices at most, evenly spread over the vertex order; all of them if there are fewer.
    surface : int
        Points drawn uniformly by area.
    seed : int
    """

    vertices: int = 20_000
    surface: int = 10_000
    seed: int = 0


class ErrorMeter:
    """Symmetric Hausdorff distance of meshes from one full mesh, by sampling.

    The greatest distance from a sample of one surface to the nearest point of the other, both
    ways: a lower bound of the true distance that vertices and surface samples make tight
    (Cignoni, Rocchini and Scopigno, "Metro: measuring error on simplified surfaces", 1998).
    """

    def __init__(self, positions: FloatArray, faces: IntArray, sampling: Sampling) -> None:
        self._sampling = sampling
        self._low, self._scale = _frame(positions)
        self._full = _mesh((positions - self._low) * self._scale, faces)
        self._samples = _sample(self._full, sampling)

    def error_m(self, positions: FloatArray, faces: IntArray) -> float:
        """Return the error in the unit of the positions, at least 0."""
        return self.distances_m(positions, faces)[0]

    def distances_m(self, positions: FloatArray, faces: IntArray) -> tuple[float, float]:
        """Return the error, and the mean distance of the points drawn by area, both ways."""
        level = _mesh((positions - self._low) * self._scale, faces)
        there = _distances(self._samples, level)
        back = _distances(_sample(level, self._sampling), self._full)
        by_area = slice(-self._sampling.surface or None, None)
        mean = (there[by_area].mean() + back[by_area].mean()) / 2.0
        return float(max(there.max(), back.max())) / self._scale, float(mean) / self._scale


def nearest_faces(positions: FloatArray, faces: IntArray, points: FloatArray) -> IntArray:
    """Return for each of (n, 3) points the face of the mesh that lies nearest, (n,)."""
    low, scale = _frame(positions)
    mesh = _mesh((positions - low) * scale, faces)
    return np.concatenate([face for _, face in _closest(mesh, (points - low) * scale)])


def _frame(positions: FloatArray) -> tuple[FloatArray, float]:
    """Return the corner and the factor that bring a mesh to a size of 1000.

    trimesh compares products of four edges with 1e-13, so that edges must not be below 1e-3.
    """
    return positions.min(axis=0), 1000.0 / float(np.ptp(positions, axis=0).max())


def _mesh(positions: FloatArray, faces: IntArray) -> Any:
    import trimesh

    return trimesh.Trimesh(positions, faces, process=False)


def _sample(mesh: Any, sampling: Sampling) -> FloatArray:
    import trimesh

    used = np.unique(np.asarray(mesh.faces))
    pick = np.linspace(0, len(used) - 1, min(len(used), sampling.vertices)).astype(np.int64)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)[used[pick]]
    if not sampling.surface:
        return vertices
    sampler: Any = trimesh.sample
    drawn = sampler.sample_surface(mesh, sampling.surface, seed=sampling.seed)
    return np.concatenate((vertices, np.asarray(drawn[0], dtype=np.float64)))


def _distances(points: FloatArray, mesh: Any) -> FloatArray:
    return np.concatenate([distance for distance, _ in _closest(mesh, points)])


def _closest(mesh: Any, points: FloatArray) -> Iterator[tuple[FloatArray, IntArray]]:
    """Yield distances to the mesh and nearest faces, chunk by chunk of the points.

    The candidate faces of a point lie in a box that reaches its nearest vertex.  Far from a dense
    mesh they are many, so chunks are cut by their number, estimated by the centroids in the
    sphere about the box.
    """
    import trimesh
    from scipy.spatial import KDTree

    reach = np.asarray(mesh.kdtree.query(points)[0], dtype=np.float64) * np.sqrt(3.0)
    centroids: Any = KDTree(np.asarray(mesh.triangles_center))
    count = centroids.query_ball_point(points, reach, return_length=True)
    number = np.cumsum(np.asarray(count) + 8) // _CANDIDATES
    cuts = np.flatnonzero(np.diff(number)) + 1
    edges = [0, *cuts.tolist(), len(points)]
    for start, end in pairwise(edges):
        _, distance, face = trimesh.proximity.closest_point(mesh, points[start:end])
        yield np.asarray(distance, dtype=np.float64), np.asarray(face, dtype=np.int32)
