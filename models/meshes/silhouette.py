"""How much of its bounding sphere's disc a mesh covers."""

from functools import cache

import numpy as np

from ...base.arrays import FloatArray
from .geometry import LevelMesh

_POINTS = 40_000
_CELLS = 40  # across the disc
_AZIMUTHS = 12
_ELEVATIONS_DEG = (0.0, 10.0, 25.0)  # as walkers and low flights see things, in turn


def disc_share(mesh: LevelMesh, center_m: FloatArray, radius_m: float) -> float:
    """Return the mean share of the disc that the silhouette covers, seen from about eye height.

    Points scattered evenly over the surface mark the cells of a grid that it covers; parts thinner
    than a cell, a fortieth of the diameter, count as wide as one.
    """
    points = (_scattered(mesh) - center_m) / radius_m
    shares: list[float] = []
    for step in range(_AZIMUTHS):
        azimuth = 2.0 * np.pi * step / _AZIMUTHS
        elevation = np.radians(_ELEVATIONS_DEG[step % len(_ELEVATIONS_DEG)])
        sine, cosine = np.sin(azimuth), np.cos(azimuth)
        right = np.array((-sine, cosine, 0.0))
        up = np.array((cosine * np.sin(elevation), sine * np.sin(elevation), np.cos(elevation)))
        plane = np.stack((points @ right, points @ up), axis=1)
        cell = np.clip((0.5 * _CELLS * (plane + 1.0)).astype(np.int64), 0, _CELLS - 1)
        covered = np.zeros(_CELLS**2, dtype=np.bool_)
        covered[cell[:, 0] * _CELLS + cell[:, 1]] = True
        shares.append(np.count_nonzero(covered) / (np.pi / 4.0 * _CELLS**2))
    return min(1.0, float(np.mean(shares)))


def _scattered(mesh: LevelMesh) -> FloatArray:
    """Return points spread evenly over a mesh's surface, the same on every call, (n, 3)."""
    chance, along = _draws()
    corner = mesh.vertices.astype(np.float64)[mesh.faces]
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.linalg.norm(np.cross(first, second), axis=1)
    if not area.sum() > 0.0:
        return corner.reshape(-1, 3)
    upto = np.cumsum(area / area.sum())
    face = np.searchsorted(upto / upto[-1], chance, side="right")
    return corner[face, 0] + along[0] * first[face] + along[1] * second[face]


@cache
def _draws() -> tuple[FloatArray, FloatArray]:
    """Return what chooses a triangle (n,) and a point in it (2, n, 1), the same for all meshes."""
    rng = np.random.default_rng(0)
    chance, along = rng.random(_POINTS), rng.uniform(size=(2, _POINTS, 1))
    return chance, np.abs(along - (along.sum(axis=0) > 1.0))  # the square's far half, folded back
