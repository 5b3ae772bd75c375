"""Primitives that generated scenes are built from: lumps, rough boxes, surfaces of revolution."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from .surface_mesh import MeshPart


def move_part(
    mesh: MeshPart,
    center: tuple[float, float, float],
    size: float | tuple[float, float, float],
) -> MeshPart:
    """Return a part scaled about the origin, then moved."""
    return MeshPart(mesh.vertices * np.asarray(size) + np.asarray(center), mesh.faces)


def lump(rng: np.random.Generator, subdivisions: int, roughness: float) -> MeshPart:
    """Return a unit sphere of 20 · 4^subdivisions triangles, moved in and out by noise."""
    import trimesh

    sphere: Any = trimesh.creation.icosphere(subdivisions=subdivisions)
    points = np.asarray(sphere.vertices, dtype=np.float64)
    radius = 1.0 + roughness * noise(points, rng)
    return MeshPart(points * radius[:, None], np.asarray(sphere.faces, dtype=np.int64))


def rough_box(rng: np.random.Generator, cells: int) -> MeshPart:
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
    face = grid_faces(cells, cells)
    faces = np.concatenate([face + i * len(u) for i in range(6)])
    inner = (np.abs(points) < 0.5 - 1e-9).sum(axis=1) == 2
    push = 1.0 + np.where(inner, 0.02 * noise(4.0 * points, rng), 0.0)
    return MeshPart(points * push[:, None], faces)


def revolved(profile: Sequence[tuple[float, float]], sides: int) -> MeshPart:
    """Return a surface of revolution about z through (height, radius) pairs, open at its ends."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    height, radius = np.array(profile, dtype=np.float64).T
    ring = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    flat = radius[:, None, None] * ring
    points = np.concatenate((flat, np.broadcast_to(height[:, None, None], (*flat.shape[:2], 1))), 2)
    face = grid_faces(len(profile) - 1, sides)
    row, column = np.divmod(face, sides + 1)
    return MeshPart(points.reshape(-1, 3), (row * sides + column % sides)[:, ::-1])


def grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    """Return two triangles for each cell of a grid of (rows + 1) · (columns + 1) points."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(rows), np.arange(columns)))
    a = i * (columns + 1) + j
    b = a + columns + 1
    return np.concatenate((np.stack((a, b, b + 1), 1), np.stack((a, b + 1, a + 1), 1)))


def noise(points: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return smooth noise in about [-1, 1] at points: waves in random directions, three octaves."""
    total = np.zeros(len(points))
    for octave in range(3):
        waves = rng.normal(0.0, 1.8 * 2.0**octave, (6, 3))
        phase = rng.uniform(0.0, 2.0 * np.pi, 6)
        total += np.sin(points @ waves.T + phase).sum(axis=1) / (6.0 * 2.0**octave)
    return total
