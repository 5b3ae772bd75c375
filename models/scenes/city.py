"""The HLOD thesis' city: 114 sides of blocks, acquired from the street, 8.95 million triangles.

Thesis on out-of-core hierarchical levels of detail with temporal hysteresis, section 3.2.  Each
side is a wall of a fine grid with a textured front and an untextured roof, cut into a tree by
factor 4.  The thesis prints 900 triangles wanted a node, 2,296 nodes and 8.95 million triangles;
as leaves that hold all triangles must then hold some 5,000 each, so many are wanted here.  13
distinct walls stand in 114 places along the streets; the thesis' 114 are all distinct.

Walls are on grids whose columns and rows lie on the cutting planes, so that leaves have exactly
the triangles of the walls.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ..hlod.hlod_scene import hlod_scene
from ..hlod.hlod_tree import Hlod, HlodOptions, build_hlod
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.shapes import grid_faces, noise
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..scene.scene import Scene
from .scene_registry import BundledScene

TRIANGLES = 8_950_000
_SEED = 2004
_HEIGHT_M = 16.0
_ROOF_M = 6.0
_PITCH_M, _STREET_M = 160.0, 22.0
_COLUMNS = 6  # of blocks
_TEXTURE_BYTES = 937e6 * 4.0 * 4.0 / 3.0  # of all walls: 937 million pixels, RGBA8 with mips
_SAMPLING = Sampling(vertices=1_500, surface=500)


@dataclass(frozen=True, slots=True)
class _Wall:
    """A distinct wall: grid columns along the street, rows up, rows of the roof, and copies."""

    levels: int
    length_m: float
    columns: int
    rows: int
    roof_rows: int
    copies: int

    @property
    def triangles(self) -> int:
        """Triangles of front and roof."""
        return 2 * self.columns * (self.rows + self.roof_rows)


_WALLS = (
    _Wall(4, 128.0, 1152, 156, 6, 8),
    _Wall(3, 96.0, 400, 112, 6, 10),
    _Wall(3, 112.0, 432, 104, 4, 10),
    _Wall(3, 96.0, 384, 112, 8, 9),
    _Wall(3, 104.0, 416, 108, 6, 9),
    _Wall(3, 112.0, 400, 112, 4, 9),
    _Wall(2, 64.0, 200, 56, 4, 10),
    _Wall(2, 72.0, 208, 52, 4, 10),
    _Wall(2, 80.0, 192, 56, 6, 10),
    _Wall(2, 64.0, 184, 60, 4, 10),
    _Wall(2, 96.0, 216, 52, 2, 9),
    _Wall(2, 88.0, 204, 56, 2, 9),
)
_LARGEST = _Wall(5, 128.0, 1024, 92, 4, 1)  # with aerials, so that the sum is exact


def build_city() -> tuple[Scene, Geometry]:
    """Return the city on the ground, its middle at the origin."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    walls = (_LARGEST, *_WALLS)
    rest = TRIANGLES - sum(wall.triangles * wall.copies for wall in walls)
    meshes = [_wall_mesh(_LARGEST, 0, shape_rng, aerials=rest // 4)]
    meshes += [_wall_mesh(wall, i + 1, shape_rng) for i, wall in enumerate(_WALLS)]
    trees = [_tree(wall, mesh) for wall, mesh in zip(walls, meshes, strict=True)]
    kind = place_rng.permutation(np.repeat(np.arange(len(walls)), [w.copies for w in walls]))
    lengths = np.array([wall.length_m for wall in walls])[kind]
    position, yaw = _sides(lengths)
    return hlod_scene("city", trees, kind, position, yaw, np.ones(len(kind)))


def _tree(wall: _Wall, mesh: SurfaceMesh) -> Hlod:
    """Return a tree of exactly so many levels: as coarse at the top as a leaf is large."""
    wanted = len(mesh.faces) // 4 ** (wall.levels - 1)
    return build_hlod(mesh, HlodOptions(wanted + 1, 4, wall.levels), _SAMPLING)


def _wall_mesh(
    wall: _Wall, number: int, rng: np.random.Generator, *, aerials: int = 0
) -> SurfaceMesh:
    """Return a wall along x that looks towards -y, its roof behind it."""
    x = np.linspace(0.0, wall.length_m, wall.columns + 1)
    front = _front(x, wall, rng)
    roof = _roof(x, wall, rng)
    parts = [front, roof]
    if aerials:
        parts.append(_aerials(aerials, wall.length_m))
    share = wall.length_m / sum(w.length_m * w.copies for w in (_LARGEST, *_WALLS))
    return clean_surface(f"wall-{number}", parts, texture_bytes=share * _TEXTURE_BYTES)


def _front(x: FloatArray, wall: _Wall, rng: np.random.Generator) -> MeshPart:
    """Return a scanned front: bays and windows, uneven by a few centimetres."""
    z = np.linspace(0.0, _HEIGHT_M, wall.rows + 1)
    u, v = (a.ravel() for a in np.meshgrid(x, z, indexing="ij"))
    window = (np.sin(np.pi * u / 2.0) > 0.3) & (np.sin(np.pi * v / 2.0) > 0.2)
    bay = 0.4 * (np.sin(np.pi * u / 8.0) > 0.4)
    grain = 0.06 * noise(np.stack((u, v, np.zeros_like(u)), axis=1), rng)
    depth = 0.25 * window - bay + grain + rng.normal(0.0, 0.01, len(u))
    uv = np.stack((u / wall.length_m, v / _HEIGHT_M), axis=1)
    faces = grid_faces(wall.columns, wall.rows)
    return MeshPart(np.stack((u, depth, v), axis=1), faces, 0, textured=True, uv=uv)


def _roof(x: FloatArray, wall: _Wall, rng: np.random.Generator) -> MeshPart:
    """Return a flat roof below the parapet, seen from the air only, without texture."""
    y = np.linspace(0.6, _ROOF_M, wall.roof_rows + 1)
    u, v = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))
    height = _HEIGHT_M - 0.8 + 0.15 * noise(np.stack((u, v, np.zeros_like(u)), axis=1), rng)
    points = np.stack((u, v, height), axis=1)
    return MeshPart(points, grid_faces(wall.columns, wall.roof_rows), 1)


def _aerials(count: int, length_m: float) -> MeshPart:
    """Return small tetrahedra on the roof, each inside one cell of the finest level."""
    corner = np.array(((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.1, 0.2, 0.0), (0.1, 0.1, 0.4)))
    faces = np.array(((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)))
    cell, place = np.divmod(np.arange(count), -(-count // 64))
    x = (cell + 0.4) * length_m / 64.0
    y = 1.0 + 0.25 * place
    at = np.stack((x, y, np.full(count, _HEIGHT_M - 0.6)), axis=1)
    points = (at[:, None] + corner).reshape(-1, 3)
    return MeshPart(points, (4 * np.arange(count)[:, None, None] + faces).reshape(-1, 3), 1)


def _sides(length_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return place (B, 3) and yaw (B,) of walls about square blocks, four a block."""
    block, side = np.divmod(np.arange(len(length_m)), 4)
    rows = -(-int(block[-1] + 1) // _COLUMNS)
    middle = np.stack((block % _COLUMNS, block // _COLUMNS), axis=1).astype(np.float64)
    middle = (middle - (np.array((_COLUMNS, rows)) - 1.0) / 2.0) * _PITCH_M
    yaw = side * np.pi / 2.0
    half = (_PITCH_M - _STREET_M) / 2.0
    along = np.stack((np.cos(yaw), np.sin(yaw)), axis=1)
    out = np.stack((np.sin(yaw), -np.cos(yaw)), axis=1)
    start = middle + half * out - (length_m / 2.0)[:, None] * along
    return np.column_stack((start, np.zeros(len(start)))), yaw


def street_route_m() -> FloatArray:
    """Return a way along the streets, (n, 2): round several blocks, back to its start."""
    x = np.array((-1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, -1.0, -1.0))
    y = np.array((-1.5, -1.5, -0.5, -0.5, 0.5, 0.5, 1.5, 1.5, -1.5))
    return _PITCH_M * np.stack((x, y), axis=1)


CITY = BundledScene(
    "114 walls of blocks as trees of 2,298 nodes, 8.95 million triangles", build_city
)
