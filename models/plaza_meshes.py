"""Meshes of the bundled scene, from primitives and smooth noise; no data files."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .arrays import FloatArray
from .surface_mesh import MeshPart, SurfaceMesh, clean_surface

__all__ = ["figure_mesh", "house_mesh", "rock_mesh", "tree_mesh"]


def tree_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a tree 6 m tall: a tapering trunk and four leafy lumps."""
    trunk = _revolved([(0.0, 0.45), (0.6, 0.28), (2.5, 0.2), (5.0, 0.12)], 12)
    lumps = [
        _moved(_lump(rng, subdivisions, 0.16), center, radius)
        for subdivisions, center, radius in (
            (3, (0.0, 0.0, 6.2), 1.7),
            (3, (1.1, 0.3, 4.6), 1.4),
            (2, (-0.8, 0.9, 4.4), 1.2),
            (2, (-0.3, -1.1, 4.8), 1.2),
        )
    ]
    return _finish("tree", [trunk, *lumps], height_m=6.0)


def rock_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a boulder 1.2 m tall."""
    return _finish("rock", [_moved(_lump(rng, 3, 0.22), (0.0, 0.0, 0.0), 1.0)], height_m=1.2)


def house_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a house 6 m tall: rough walls, a tiled gable roof, a chimney, columns, windows."""
    walls = _moved(_rough_box(rng, 12), (0.0, 0.0, 2.5), (8.0, 6.0, 5.0))
    chimney = _moved(_rough_box(rng, 3), (2.5, 1.0, 7.8), (0.8, 0.8, 2.4))
    columns = [
        _moved(_revolved([(0.0, 0.3), (0.3, 0.2), (2.2, 0.18), (2.5, 0.3)], 12), (x, -4.2, 0.0), 1)
        for x in (-3.0, -1.0, 1.0, 3.0)
    ]
    windows = [
        _moved(_rough_box(rng, 1), (x, side * 3.02, z), (1.0, 0.2, 1.2))
        for x in (-2.6, 0.0, 2.6)
        for z in (1.6, 3.8)
        for side in (-1, 1)
    ]
    return _finish("house", [walls, _roof(), chimney, *columns, *windows], height_m=6.0)


def figure_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a person 1.8 m tall, as a statue: body, head, arms and legs."""
    limbs = [
        _moved(_lump(rng, 2, 0.08), center, radii)
        for center, radii in (
            ((-0.12, 0.0, 0.42), (0.1, 0.11, 0.44)),
            ((0.12, 0.0, 0.42), (0.1, 0.11, 0.44)),
            ((-0.28, 0.0, 1.08), (0.07, 0.08, 0.34)),
            ((0.28, 0.0, 1.08), (0.07, 0.08, 0.34)),
        )
    ]
    body = _moved(_lump(rng, 3, 0.08), (0.0, 0.0, 1.1), (0.23, 0.15, 0.38))
    head = _moved(_lump(rng, 2, 0.06), (0.0, 0.0, 1.64), (0.11, 0.13, 0.16))
    return _finish("figure", [body, head, *limbs], height_m=1.8)


def _finish(name: str, meshes: Sequence[MeshPart], *, height_m: float) -> SurfaceMesh:
    return clean_surface(name, meshes).standing(y_up=False, height_m=height_m)


def _moved(
    mesh: MeshPart,
    center: tuple[float, float, float],
    size: float | tuple[float, float, float],
) -> MeshPart:
    return MeshPart(mesh.vertices * np.asarray(size) + np.asarray(center), mesh.faces)


def _lump(rng: np.random.Generator, subdivisions: int, roughness: float) -> MeshPart:
    """Return a unit sphere of 20 · 4^subdivisions triangles, moved in and out by noise."""
    import trimesh

    sphere: Any = trimesh.creation.icosphere(subdivisions=subdivisions)
    points = np.asarray(sphere.vertices, dtype=np.float64)
    radius = 1.0 + roughness * _noise(points, rng)
    return MeshPart(points * radius[:, None], np.asarray(sphere.faces, dtype=np.int64))


def _rough_box(rng: np.random.Generator, cells: int) -> MeshPart:
    """Return a unit box of 12 · cells² triangles about the origin, its walls slightly uneven."""
    steps = np.linspace(-0.5, 0.5, cells + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps, indexing="ij"))
    sides: list[FloatArray] = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            columns = [u, v] if side > 0 else [v, u]
            columns.insert(axis, np.full_like(u, side))
            order = np.stack(columns, axis=1)
            # The axis in the middle turns the winding over.
            sides.append(order[:, [2, 1, 0]] if axis == 1 else order)
    points = np.concatenate(sides)
    face = _grid_faces(cells, cells)
    faces = np.concatenate([face + i * len(u) for i in range(6)])
    inner = (np.abs(points) < 0.5 - 1e-9).sum(axis=1) == 2
    push = 1.0 + np.where(inner, 0.02 * _noise(4.0 * points, rng), 0.0)
    return MeshPart(points * push[:, None], faces)


def _roof() -> MeshPart:
    """Return a gable roof with rows of tiles: an open sheet from eave over ridge to eave."""
    across, along = 24, 30
    s, t = np.meshgrid(np.linspace(-1, 1, across + 1), np.linspace(-1, 1, along + 1), indexing="ij")
    tiles = 0.05 * np.abs(np.sin(np.pi * along / 2 * t)) + 0.05 * (np.abs(s) * across / 2 % 1.0)
    sheet = np.stack((4.6 * t, 3.7 * s, 8.0 - 3.2 * np.abs(s) + tiles), axis=-1)
    return MeshPart(sheet.reshape(-1, 3), _grid_faces(across, along)[:, ::-1])


def _revolved(profile: Sequence[tuple[float, float]], sides: int) -> MeshPart:
    """Return a surface of revolution about z through (height, radius) pairs, open at its ends."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    height, radius = np.array(profile, dtype=np.float64).T
    ring = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    flat = radius[:, None, None] * ring
    points = np.concatenate((flat, np.broadcast_to(height[:, None, None], (*flat.shape[:2], 1))), 2)
    face = _grid_faces(len(profile) - 1, sides)
    row, column = np.divmod(face, sides + 1)
    return MeshPart(points.reshape(-1, 3), (row * sides + column % sides)[:, ::-1])


def _grid_faces(rows: int, columns: int) -> Any:
    """Return two triangles for each cell of a grid of (rows + 1) · (columns + 1) points."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(rows), np.arange(columns)))
    a = i * (columns + 1) + j
    b = a + columns + 1
    return np.concatenate((np.stack((a, b, b + 1), 1), np.stack((a, b + 1, a + 1), 1)))


def _noise(points: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return smooth noise in about [-1, 1] at points: waves in random directions, three octaves."""
    total = np.zeros(len(points))
    for octave in range(3):
        waves = rng.normal(0.0, 1.8 * 2.0**octave, (6, 3))
        phase = rng.uniform(0.0, 2.0 * np.pi, 6)
        total += np.sin(points @ waves.T + phase).sum(axis=1) / (6.0 * 2.0**octave)
    return total
