"""Bounding volumes of 3D Tiles as bounding spheres.

Boxes and spheres stand in their tile's frame and are placed by its transform; regions are angles
and heights about the WGS 84 ellipsoid, which no transform moves.
"""

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .tile_schema import Volume

_BOX, _SPHERE, _REGION = 0, 1, 2
_SEMI_MAJOR_M = 6_378_137.0  # WGS 84
_ECCENTRICITY_2 = 6.694_379_990_141_316e-3
_GRID = 5  # points along each edge of a region


def read_volume(volume: Volume) -> tuple[int, tuple[float, ...]]:
    """Return the kind of a volume and its numbers, 12 with zeros at the end.

    Raises `InputError` if there is no box, sphere or region, or its numbers are not finite or
    empty.
    """
    given = [(k, v) for k, v in enumerate((volume.box, volume.sphere, volume.region)) if v]
    if not given:
        raise InputError("boundingVolume: expected a box, sphere or region, got none of them")
    kind, numbers = given[0]
    if not np.isfinite(numbers).all():
        raise InputError(f"boundingVolume: expected finite numbers, got {numbers}")
    if kind == _SPHERE and numbers[3] < 0.0:
        raise InputError(f"boundingVolume: expected a radius >= 0, got {numbers[3]}")
    if kind == _REGION and not _sane(numbers):
        raise InputError(
            "boundingVolume: expected a region west, south, east, north in radians and heights "
            f"that rise, got {numbers}"
        )
    return kind, (*numbers, *(0.0,) * (12 - len(numbers)))


def _sane(region: tuple[float, ...]) -> bool:
    west, south, east, north, low, high = region
    angles = max(abs(west), abs(east)) <= 7.0 and -1.6 <= south <= north <= 1.6
    return angles and -1e5 <= low <= high <= 1e7


def bounding_spheres(
    kind: FloatArray, numbers: FloatArray, transform: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return centres (n, 3) and radii (n,) in the frame of the tileset.

    Parameters
    ----------
    kind : (n,) and numbers : (n, 12) as `read_volume` gives them
    transform : (n, 4, 4) from each tile's frame to that of the tileset
    """
    center, radius = np.empty((len(kind), 3)), np.empty(len(kind))
    linear = transform[:, :3, :3]
    for which in (_BOX, _SPHERE):
        at = np.flatnonzero(kind == which)
        local = numbers[at, :3]
        center[at] = np.einsum("nij,nj->ni", linear[at], local) + transform[at, :3, 3]
    at = np.flatnonzero(kind == _BOX)
    axes = np.einsum("nij,nkj->nki", linear[at], numbers[at, 3:].reshape(-1, 3, 3))
    signs = np.array(((1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)), dtype=np.float64)
    corner = np.einsum("sk,nki->nsi", signs, axes)
    radius[at] = np.linalg.norm(corner, axis=2).max(axis=1, initial=0.0)
    at = np.flatnonzero(kind == _SPHERE)
    # The spec scales a sphere by the largest of the three axes' scales.
    radius[at] = numbers[at, 3] * np.linalg.norm(linear[at], axis=1).max(axis=1, initial=0.0)
    at = np.flatnonzero(kind == _REGION)
    if len(at):
        center[at], radius[at] = _region_spheres(numbers[at, :6])
    return center, radius


def _region_spheres(region: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return spheres about regions, from a grid of points and the bulge between them."""
    west, south, east, north, low, high = region.T
    east = east + 2.0 * np.pi * (east < west)  # across the antimeridian
    step = np.linspace(0.0, 1.0, _GRID)
    longitude = west[:, None] + (east - west)[:, None] * step
    latitude = south[:, None] + (north - south)[:, None] * step
    points = [
        geodetic_to_ecef(longitude[:, :, None], latitude[:, None, :], h[:, None, None])
        for h in (low, high)
    ]
    cloud = np.concatenate([p.reshape(len(region), -1, 3) for p in points], axis=1)
    center = (cloud.min(axis=1) + cloud.max(axis=1)) / 2.0
    radius = np.linalg.norm(cloud - center[:, None, :], axis=2).max(axis=1)
    # Between points of a grid the surface rises above its chords by at most the sagitta.
    angle = np.maximum(east - west, north - south) / (_GRID - 1)
    bulge = (_SEMI_MAJOR_M + high) * (1.0 - np.cos(np.minimum(angle, np.pi) / np.sqrt(2.0)))
    return center, radius + bulge


def geodetic_to_ecef(
    longitude: FloatArray, latitude: FloatArray, height_m: FloatArray
) -> FloatArray:
    """Return Earth-centred coordinates in metres, (..., 3), of angles in radians on WGS 84."""
    normal = _SEMI_MAJOR_M / np.sqrt(1.0 - _ECCENTRICITY_2 * np.sin(latitude) ** 2)
    across = (normal + height_m) * np.cos(latitude)
    up = (normal * (1.0 - _ECCENTRICITY_2) + height_m) * np.sin(latitude)
    x, y, z = np.broadcast_arrays(across * np.cos(longitude), across * np.sin(longitude), up)
    return np.stack((x, y, z), axis=-1)
