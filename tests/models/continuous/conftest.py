"""Meshes that are contracted: a closed one, one with a border, and a textured tube."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh

from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


@pytest.fixture(scope="session")
def ball() -> SurfaceMesh:
    """Return a closed sphere of radius 1 and 1,280 triangles."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    return clean_surface("ball", [MeshPart(np.asarray(mesh.vertices), np.asarray(mesh.faces))])


@pytest.fixture(scope="session")
def sheet() -> SurfaceMesh:
    """Return a flat square with a border, 20 by 20 cells of a metre, two triangles each."""
    return grid_surface("sheet", np.zeros((21, 21)))


@pytest.fixture(scope="session")
def tube() -> SurfaceMesh:
    """Return a bumpy tube along z, open at both ends, with a texture seam that winds about it.

    u runs about the tube, 24 cells, and v along it, 40 cells.
    """
    around, along = 24, 40
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1)
    z = np.linspace(0.0, 6.0, along + 1)
    turn = angle[None, :] + 0.8 * z[:, None]
    radius = 1.0 + 0.1 * np.sin(3.0 * turn) * np.sin(2.0 * z[:, None])
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    points = np.stack((x, y, np.broadcast_to(z[:, None], x.shape)), axis=2)
    points[:, -1] = points[:, 0]  # the seam meets to the last bit
    u, v = np.meshgrid(angle / (2.0 * np.pi), z / 6.0)
    i, j = np.mgrid[0:along, 0:around]
    a = (i * (around + 1) + j).ravel()
    b, c = a + 1, a + around + 1
    faces = np.concatenate((np.stack((a, b, c + 1), 1), np.stack((a, c + 1, c), 1)))
    uv = np.stack((u, v), axis=2).reshape(-1, 2)
    return clean_surface("tube", [MeshPart(points.reshape(-1, 3), faces, textured=True, uv=uv)])


@pytest.fixture(scope="session")
def bending(tube: SurfaceMesh) -> np.ndarray:
    """Return four poses of the tube, (4, V, 3): straight, and bent ever more about its middle."""
    x, y, z = tube.positions.T
    poses = [tube.positions]
    for angle in (0.4, 0.8, 1.2):
        turn = np.clip(z - 2.5, 0.0, 1.0) * angle
        bent = np.stack((x, y + np.sin(turn) * (z - 2.5), 2.5 + np.cos(turn) * (z - 2.5)), axis=1)
        poses.append(np.where((z > 2.5)[:, None], bent, tube.positions))
    return np.stack(poses)


def grid_surface(name: str, height: np.ndarray) -> SurfaceMesh:
    """Return a surface over a grid of metres, two triangles a cell."""
    n, m = height.shape
    y, x = np.mgrid[0:n, 0:m]
    points = np.stack((x, y, height), axis=2).reshape(-1, 3).astype(float)
    i, j = np.mgrid[0 : n - 1, 0 : m - 1]
    a = (i * m + j).ravel()
    b, c, d = a + 1, a + m, a + m + 1
    faces = np.concatenate((np.stack((a, b, d), 1), np.stack((a, d, c), 1)))
    return clean_surface(name, [MeshPart(points, faces)])


@pytest.fixture(scope="session")
def make_grid() -> Callable[[str, np.ndarray], SurfaceMesh]:
    """Return `grid_surface`."""
    return grid_surface
