"""How much of its bounding sphere's disc a mesh covers."""

from functools import cache

import numpy as np

from ...base.arrays import FloatArray, IntArray
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
    # A product of a long table and three numbers takes ten times as long as sums of its columns.
    x, y, z = (_scattered(mesh) - center_m[:, np.newaxis]) / radius_m
    shares: list[float] = []
    for step in range(_AZIMUTHS):
        azimuth = 2.0 * np.pi * step / _AZIMUTHS
        elevation = np.radians(_ELEVATIONS_DEG[step % len(_ELEVATIONS_DEG)])
        sine, cosine = np.sin(azimuth), np.cos(azimuth)
        low, high = np.sin(elevation), np.cos(elevation)
        cell = _cells(y * cosine - x * sine)
        cell *= _CELLS
        cell += _cells(x * (cosine * low) + y * (sine * low) + z * high)
        covered = np.zeros(_CELLS**2, dtype=np.bool_)
        covered[cell] = True
        shares.append(np.count_nonzero(covered) / (np.pi / 4.0 * _CELLS**2))
    return min(1.0, float(np.mean(shares)))


def _cells(along: FloatArray) -> IntArray:
    """Return the column or row of cells for places from -1 to 1, which are used up."""
    along += 1.0
    along *= 0.5 * _CELLS
    np.clip(along, 0.0, _CELLS - 1.0, out=along)  # floats in place: four times as fast as integers
    return along.astype(np.intp)


def _scattered(mesh: LevelMesh) -> FloatArray:
    """Return points spread evenly over a mesh's surface, the same on every call, (3, n)."""
    chance, along = _draws()
    corner = mesh.vertices.astype(np.float64)[mesh.faces]
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.linalg.norm(np.cross(first, second), axis=1)
    if not area.sum() > 0.0:
        return corner.reshape(-1, 3).T
    upto = np.cumsum(area / area.sum())
    face = np.searchsorted(upto / upto[-1], chance, side="right")
    origin, first, second = (
        np.take(np.ascontiguousarray(side.T), face, axis=1)
        for side in (corner[:, 0], first, second)
    )
    first *= along[0]
    second *= along[1]
    origin += first
    origin += second
    return origin


@cache
def _draws() -> tuple[FloatArray, FloatArray]:
    """Return what chooses a triangle (n,) and a point in it (2, n), the same for all meshes.

    They rise, as which point comes first makes no difference, and neighbours are found faster.
    """
    rng = np.random.default_rng(0)
    chance, along = rng.random(_POINTS), rng.uniform(size=(2, _POINTS))
    along = np.abs(along - (along.sum(axis=0) > 1.0))  # the square's far half, folded back
    order = np.argsort(chance)
    return chance[order], along[:, order]
