"""Meshes of the bundled scene, from primitives and smooth noise; no data files."""

from collections.abc import Sequence

import numpy as np

from ...meshes.shapes import grid_faces, lump, move_part, revolved, rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def tree_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a tree 6 m tall: a tapering trunk and four leafy lumps."""
    trunk = revolved([(0.0, 0.45), (0.6, 0.28), (2.5, 0.2), (5.0, 0.12)], 12)
    lumps = [
        move_part(lump(rng, subdivisions, 0.16), center, radius)
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
    return _finish("rock", [move_part(lump(rng, 3, 0.22), (0.0, 0.0, 0.0), 1.0)], height_m=1.2)


def house_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a house 6 m tall: rough walls, a tiled gable roof, a chimney, columns, windows."""
    walls = move_part(rough_box(rng, 12), (0.0, 0.0, 2.5), (8.0, 6.0, 5.0))
    chimney = move_part(rough_box(rng, 3), (2.5, 1.0, 7.8), (0.8, 0.8, 2.4))
    columns = [
        move_part(
            revolved([(0.0, 0.3), (0.3, 0.2), (2.2, 0.18), (2.5, 0.3)], 12), (x, -4.2, 0.0), 1
        )
        for x in (-3.0, -1.0, 1.0, 3.0)
    ]
    windows = [
        move_part(rough_box(rng, 1), (x, side * 3.02, z), (1.0, 0.2, 1.2))
        for x in (-2.6, 0.0, 2.6)
        for z in (1.6, 3.8)
        for side in (-1, 1)
    ]
    return _finish("house", [walls, _roof(), chimney, *columns, *windows], height_m=6.0)


def figure_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a person 1.8 m tall, as a statue: body, head, arms and legs."""
    limbs = [
        move_part(lump(rng, 2, 0.08), center, radii)
        for center, radii in (
            ((-0.12, 0.0, 0.42), (0.1, 0.11, 0.44)),
            ((0.12, 0.0, 0.42), (0.1, 0.11, 0.44)),
            ((-0.28, 0.0, 1.08), (0.07, 0.08, 0.34)),
            ((0.28, 0.0, 1.08), (0.07, 0.08, 0.34)),
        )
    ]
    body = move_part(lump(rng, 3, 0.08), (0.0, 0.0, 1.1), (0.23, 0.15, 0.38))
    head = move_part(lump(rng, 2, 0.06), (0.0, 0.0, 1.64), (0.11, 0.13, 0.16))
    return _finish("figure", [body, head, *limbs], height_m=1.8)


def _finish(name: str, meshes: Sequence[MeshPart], *, height_m: float) -> SurfaceMesh:
    return clean_surface(name, meshes).standing(y_up=False, height_m=height_m)


def _roof() -> MeshPart:
    """Return a gable roof with rows of tiles: an open sheet from eave over ridge to eave."""
    across, along = 24, 30
    s, t = np.meshgrid(np.linspace(-1, 1, across + 1), np.linspace(-1, 1, along + 1), indexing="ij")
    tiles = 0.05 * np.abs(np.sin(np.pi * along / 2 * t)) + 0.05 * (np.abs(s) * across / 2 % 1.0)
    sheet = np.stack((4.6 * t, 3.7 * s, 8.0 - 3.2 * np.abs(s) + tiles), axis=-1)
    return MeshPart(sheet.reshape(-1, 3), grid_faces(across, along)[:, ::-1])
