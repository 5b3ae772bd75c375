"""Dense meshes of the scene ``district``, from grids, lumps and surfaces of revolution."""

from collections.abc import Sequence

import numpy as np

from ...meshes.shapes import grid_faces, lump, move_part, noise, revolved, rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def tower_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a block of flats 16 m tall with windows and balconies: 59,000 triangles."""
    walls = _facade(rng, (12.0, 10.0, 16.0), columns=240, rows=120, storeys=5, bay_m=2.0)
    return _finish("tower", [walls], height_m=16.0)


def house_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a house 8 m tall under a roof of tiles: 37,000 triangles."""
    walls = _facade(rng, (10.0, 8.0, 6.0), columns=160, rows=48, storeys=2, bay_m=2.0)
    chimneys = [
        move_part(rough_box(rng, 6), (x, 1.0, 9.0), (0.8, 0.8, 2.6)) for x in (-3.0, 0.5, 3.2)
    ]
    return _finish("house", [walls, _tiled_roof(rng), *chimneys], height_m=8.0)


def chapel_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a round chapel 10 m tall: columns, a drum, a dome: 52,000 triangles."""
    columns = [
        move_part(_column(rng), (5.6 * np.cos(angle), 5.6 * np.sin(angle), 0.0), 1.0)
        for angle in np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    ]
    height = np.linspace(0.0, 8.0, 61)
    relief = 4.2 + 0.25 * np.sin(2.0 * np.pi * height / 0.8)
    drum = _weathered(rng, revolved(list(zip(height.tolist(), relief.tolist(), strict=True)), 96))
    dome = move_part(_rough_lump(rng, 5, 0.04, 0.04), (0.0, 0.0, 8.0), (6.2, 6.2, 6.0))
    return _finish("chapel", [drum, dome, *columns], height_m=10.0)


def fountain_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a fountain 5 m tall: three basins about a rough column: 32,000 triangles."""
    basins = [
        _weathered(rng, revolved(_basin(r, z), 96)) for z, r in ((0.2, 3.0), (1.6, 1.9), (2.9, 1.1))
    ]
    column = move_part(_rough_lump(rng, 4, 0.2, 0.1), (0.0, 0.0, 2.5), (0.5, 0.5, 2.5))
    figures = [
        move_part(_rough_lump(rng, 3, 0.3, 0.1), (2.2 * np.cos(a), 2.2 * np.sin(a), 1.0), 0.6)
        for a in (0.0, 2.1, 4.2)
    ]
    return _finish("fountain", [*basins, column, *figures], height_m=5.0)


def statue_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a person in stone 4 m tall on a plinth, as a scan has it: 48,000 triangles."""
    limbs = [
        move_part(_rough_lump(rng, 4, 0.15, 0.1), center, radii)
        for center, radii in (
            ((-0.12, 0.0, 1.32), (0.1, 0.11, 0.44)),
            ((0.12, 0.0, 1.32), (0.1, 0.11, 0.44)),
            ((-0.28, 0.1, 2.0), (0.08, 0.09, 0.36)),
            ((0.3, 0.0, 2.2), (0.09, 0.08, 0.36)),
            ((0.0, -0.02, 2.56), (0.12, 0.14, 0.17)),
        )
    ]
    body = move_part(_rough_lump(rng, 5, 0.15, 0.1), (0.0, 0.0, 2.0), (0.25, 0.17, 0.4))
    plinth = move_part(rough_box(rng, 14), (0.0, 0.0, 0.45), (0.9, 0.9, 0.9))
    return _finish("statue", [body, plinth, *limbs], height_m=4.0)


def tree_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a tree 9 m tall: a trunk and eight leafy lumps: 53,000 triangles."""
    trunk = revolved([(0.0, 0.45), (0.6, 0.28), (2.5, 0.2), (5.0, 0.12)], 24)
    crown = [
        move_part(_rough_lump(rng, subdivisions, 0.3, 0.2), center, radius)
        for subdivisions, center, radius in (
            (5, (0.0, 0.0, 6.2), 1.7),
            (4, (1.1, 0.3, 4.8), 1.4),
            (4, (-0.9, 0.9, 4.6), 1.3),
            (4, (-0.3, -1.2, 5.0), 1.3),
            (4, (0.6, -0.9, 6.6), 1.1),
            (4, (-0.7, 0.5, 6.8), 1.1),
            (4, (0.4, 1.2, 5.6), 1.2),
            (3, (0.1, 0.1, 7.7), 0.9),
        )
    ]
    return _finish("tree", [trunk, *crown], height_m=9.0)


def boulder_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a boulder 2 m tall, as a scan has it: 20,480 triangles."""
    return _finish("boulder", [_rough_lump(rng, 5, 0.3, 0.1)], height_m=2.0)


def _finish(name: str, parts: Sequence[MeshPart], *, height_m: float) -> SurfaceMesh:
    return clean_surface(name, parts).standing(y_up=False, height_m=height_m)


def _rough_lump(
    rng: np.random.Generator, subdivisions: int, roughness: float, grain: float
) -> MeshPart:
    """Return a lump with a grain that only its finer levels can hold."""
    part = lump(rng, subdivisions, roughness)
    return MeshPart(
        part.vertices * (1.0 + grain * noise(5.0 * part.vertices, rng))[:, None], part.faces
    )


def _basin(radius_m: float, foot_m: float) -> list[tuple[float, float]]:
    """Return (height, radius) pairs of a bowl: out along its foot, up its side, and in again."""
    angle = np.linspace(0.05, np.pi - 0.05, 41)
    height = foot_m + 0.2 * radius_m * (1.0 - np.cos(angle))
    return list(zip(height.tolist(), (radius_m * np.sin(angle)).tolist(), strict=True))


def _weathered(rng: np.random.Generator, part: MeshPart, grain_m: float = 0.02) -> MeshPart:
    """Return a part uneven by a few centimetres.

    On a perfect surface of revolution many collapses cost exactly nothing, and the simplifier
    folds it up.
    """
    return MeshPart(part.vertices + rng.normal(0.0, grain_m, part.vertices.shape), part.faces)


def _column(rng: np.random.Generator) -> MeshPart:
    """Return a fluted column 7 m tall with base and capital."""
    height = np.linspace(0.0, 7.0, 21)
    radius = 0.4 - 0.012 * height + 0.15 * (np.abs(height - 3.5) > 3.2)
    part = revolved(list(zip(height.tolist(), radius.tolist(), strict=True)), 32)
    x, y, z = part.vertices.T
    flute = 1.0 - 0.1 * np.abs(np.sin(8.0 * np.arctan2(y, x)))
    return _weathered(rng, MeshPart(np.stack((x * flute, y * flute, z), axis=1), part.faces), 0.01)


def _facade(
    rng: np.random.Generator,
    size_m: tuple[float, float, float],
    *,
    columns: int,
    rows: int,
    storeys: int,
    bay_m: float,
) -> MeshPart:
    """Return four walls and a flat roof as one grid: windows go in, balconies stand out."""
    length, depth, height = size_m
    around = 2.0 * (length + depth)
    u, v = np.meshgrid(
        np.linspace(0.0, around, columns + 1), np.linspace(0.0, height, rows + 1), indexing="ij"
    )
    corner = np.array(((0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth), (0.0, 0.0)))
    along = np.cumsum((0.0, length, depth, length, depth))
    plan = np.stack([np.interp(u, along, corner[:, i]) - corner[2, i] / 2.0 for i in (0, 1)], -1)
    side = np.minimum(np.searchsorted(along, u, side="right") - 1, 3)
    outward = np.array(((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)))[side]
    across, up = u / bay_m % 1.0, v * storeys / height % 1.0
    window = (np.abs(across - 0.5) < 0.25) & (np.abs(up - 0.6) < 0.25)
    balcony = (np.abs(across - 0.5) < 0.35) & (up < 0.2)
    points = np.stack((plan[..., 0], plan[..., 1], v), axis=-1)
    out = 1.0 * balcony - 0.5 * window + 0.08 * noise(points.reshape(-1, 3), rng).reshape(u.shape)
    points[..., :2] += out[..., None] * outward
    points[-1] = points[0]  # closed to the bit
    inside = np.array((0.8, 0.4, 0.0))[None, :, None] * points[:, -1:, :2]
    roof = np.concatenate((inside, np.full((columns + 1, 3, 1), height)), axis=-1)
    points = np.concatenate((points, roof), axis=1)
    return MeshPart(points.reshape(-1, 3), grid_faces(columns, rows + 3))


def _tiled_roof(rng: np.random.Generator) -> MeshPart:
    """Return a gable roof with rows of round tiles, an open sheet from eave over ridge to eave."""
    across, along = 90, 110
    s, t = np.meshgrid(np.linspace(-1, 1, across + 1), np.linspace(-1, 1, along + 1), indexing="ij")
    tiles = 0.12 * np.abs(np.sin(np.pi * along / 10.0 * t)) + 0.12 * (
        np.abs(s) * across / 10.0 % 1.0
    )
    sag = 0.08 * noise(np.stack((4.0 * t, 3.0 * s, 0.0 * s), axis=-1).reshape(-1, 3), rng)
    z = 10.0 - 4.0 * np.abs(s) + tiles + sag.reshape(s.shape)
    sheet = np.stack((5.4 * t, 4.6 * s, z), axis=-1)
    return MeshPart(sheet.reshape(-1, 3), grid_faces(across, along)[:, ::-1])
