"""Meshes of the scenes that machines are calibrated on: few large triangles, and many small ones.

The small ones are of unlike shapes, since what a triangle costs may depend on how vertices are
shared, how far the indices of a triangle lie apart and how many triangles face away.
"""

from collections.abc import Sequence

import numpy as np

from ....base.arrays import FloatArray
from ...meshes.shapes import grid_faces, lump, move_part, noise, revolved, rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def wall_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a wall 8 m tall with a pillar at each end: 144 triangles of two materials."""
    pillars = [
        _painted(move_part(rough_box(rng, 1), (x, 0.0, 4.0), (1.5, 1.5, 8.0)), 1)
        for x in (-3.0, 3.0)
    ]
    wall = move_part(rough_box(rng, 3), (0.0, 0.0, 3.5), (6.0, 0.8, 7.0))
    coping = _painted(move_part(rough_box(rng, 1), (0.0, 0.0, 7.2), (6.4, 1.2, 0.4)), 1)
    return _finish("wall", [wall, coping, *pillars], height_m=8.0)


def board_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a board 7 m tall with a picture on it: 132 triangles, the picture's textured."""
    across, up = 6, 5
    x, z = np.meshgrid(
        np.linspace(-3.0, 3.0, across + 1), np.linspace(2.0, 7.0, up + 1), indexing="ij"
    )
    bulge = 0.15 * noise(np.stack((x, 0.0 * x, z), axis=-1).reshape(-1, 3), rng)
    front = np.stack((x.ravel(), -0.3 + bulge, z.ravel()), axis=1)
    uv = np.stack(((x.ravel() + 3.0) / 6.0, (z.ravel() - 2.0) / 5.0), axis=1)
    face = grid_faces(across, up)
    picture = MeshPart(front, face[:, ::-1], material=1, textured=True, uv=uv)
    back = move_part(rough_box(rng, 2), (0.0, 0.3, 4.5), (6.0, 0.4, 5.0))
    legs = [move_part(rough_box(rng, 1), (x, 0.3, 1.0), (0.4, 0.4, 2.0)) for x in (-2.2, 2.2)]
    return _finish("board", [back, picture, *legs], height_m=7.0)


def pylon_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a column 12 m tall on a square foot: 156 triangles."""
    profile = [
        (0.8, 1.6),
        (1.6, 1.2),
        (4.0, 1.1),
        (8.0, 1.0),
        (11.2, 0.9),
        (11.6, 1.5),
        (12.0, 1.4),
    ]
    shaft = revolved(profile, 12)
    foot = move_part(rough_box(rng, 1), (0.0, 0.0, 0.4), (3.6, 3.6, 0.8))
    return _finish("pylon", [shaft, foot], height_m=12.0)


def crag_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a crag 6 m tall: 320 triangles."""
    return _finish(
        "crag", [move_part(lump(rng, 2, 0.3), (0.0, 0.0, 0.0), (3.4, 2.8, 3.0))], height_m=6.0
    )


def pebble_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a rough ball 1.5 m tall: 5,120 triangles."""
    return _finish("pebble", [_grained(rng, lump(rng, 4, 0.2), 0.06)], height_m=1.5)


def ring_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return an upright ring 3 m tall, ribbed: 14,400 triangles."""
    turn = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
    curve = np.stack((np.cos(turn), 0.0 * turn, np.sin(turn)), axis=1)
    thick = 0.3 + 0.05 * np.sin(24.0 * turn)
    return _finish("ring", [_tube(rng, curve, thick, sides=40, closed=True)], height_m=3.0)


def urn_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return an urn 2.5 m tall with a beaded wall, open at its ends: 24,320 triangles."""
    height = np.linspace(0.0, 2.5, 96)
    radius = 0.55 + 0.4 * np.sin(1.4 * height) ** 2 - 0.25 * (height > 2.2)
    body = revolved(list(zip(height.tolist(), radius.tolist(), strict=True)), 128)
    x, y, z = body.vertices.T
    bead = 1.0 + 0.05 * np.sin(20.0 * np.arctan2(y, x)) * np.sin(24.0 * z)
    beaded = MeshPart(np.stack((x * bead, y * bead, z), axis=1), body.faces)
    return _finish("urn", [_grained(rng, beaded, 0.02)], height_m=2.5)


def hill_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a hill of ground 2 m tall, an open sheet: 33,800 triangles."""
    cells = 130
    steps = np.linspace(-1.0, 1.0, cells + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps, indexing="ij"))
    points = np.stack((2.0 * x, 2.0 * y, np.zeros_like(x)), axis=1)
    edge = (1.0 - x**2) * (1.0 - y**2)
    height = edge * (1.0 + 0.5 * noise(points, rng) + 0.12 * noise(5.0 * points, rng))
    sheet = MeshPart(np.stack((1.5 * x, 1.5 * y, height), axis=1), grid_faces(cells, cells))
    return _finish("hill", [sheet], height_m=2.0)


def knot_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a knotted rope 3 m tall, wound three times about a ring: 46,080 triangles."""
    turn = np.linspace(0.0, 2.0 * np.pi, 480, endpoint=False)
    out = 1.0 + 0.42 * np.cos(3.0 * turn)
    curve = np.stack(
        (out * np.cos(2.0 * turn), 0.42 * np.sin(3.0 * turn), out * np.sin(2.0 * turn)), axis=1
    )
    thick = 0.2 + 0.015 * np.sin(96.0 * turn)
    return _finish("knot", [_tube(rng, curve, thick, sides=48, closed=True)], height_m=3.0)


def coral_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a coral 2.5 m tall: a rough foot and 12 bent arms: 56,960 triangles."""
    parts = [_grained(rng, move_part(lump(rng, 4, 0.2), (0.0, 0.0, 0.3), (0.9, 0.9, 0.4)), 0.05)]
    along = np.linspace(0.0, 1.0, 91)
    for number in range(12):
        turn = 2.0 * np.pi * number / 12.0 + rng.uniform(-0.2, 0.2)
        lean, bend = rng.uniform(0.3, 1.0), rng.uniform(-0.6, 0.6)
        angle = turn + bend * along
        radius = 0.4 + lean * along**1.5
        curve = np.stack(
            (radius * np.cos(angle), radius * np.sin(angle), 0.3 + 2.2 * along), axis=1
        )
        thick = 0.17 * (1.0 - 0.85 * along**2)
        parts.append(_tube(rng, curve, thick, sides=24, closed=False))
    return _finish("coral", parts, height_m=2.5)


def _finish(name: str, parts: Sequence[MeshPart], *, height_m: float) -> SurfaceMesh:
    return clean_surface(name, parts).standing(y_up=False, height_m=height_m)


def _painted(part: MeshPart, material: int) -> MeshPart:
    return MeshPart(part.vertices, part.faces, material)


def _grained(rng: np.random.Generator, part: MeshPart, grain: float) -> MeshPart:
    """Return a part with fine bumps, which only its finer levels can hold."""
    bump = grain * (noise(6.0 * part.vertices, rng) + 0.1 * rng.normal(size=len(part.vertices)))
    return MeshPart(part.vertices * (1.0 + bump)[:, None], part.faces)


def _tube(
    rng: np.random.Generator, curve: FloatArray, thick: FloatArray, *, sides: int, closed: bool
) -> MeshPart:
    """Return a tube of n rings of points about a curve (n, 3), `thick` (n,) its radius.

    Rings follow a frame that is carried along the curve without twist; on a closed curve what
    twist is left at the end is spread over all rings.
    """
    ahead = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    if not closed:
        ahead = np.gradient(curve, axis=0)
    tangent = ahead / np.linalg.norm(ahead, axis=1)[:, None]
    normal = np.empty_like(curve)
    normal[0] = _across(np.array((0.0, 1.0, 0.3)), tangent[0])
    for i in range(1, len(curve)):
        normal[i] = _across(normal[i - 1], tangent[i])
    binormal = np.cross(tangent, normal)
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    spin = np.zeros(len(curve))
    if closed:
        last = _across(normal[-1], tangent[0])
        twist = np.arctan2(last @ binormal[0], last @ normal[0])
        spin = -twist * np.arange(len(curve)) / len(curve)
    turn = angle + spin[:, None]
    rough = thick[:, None] * (1.0 + 0.05 * rng.normal(size=turn.shape))
    points = curve[:, None] + rough[..., None] * (
        np.cos(turn)[..., None] * normal[:, None] + np.sin(turn)[..., None] * binormal[:, None]
    )
    rings = len(curve) if closed else len(curve) - 1
    row, column = np.divmod(grid_faces(rings, sides), sides + 1)
    faces = row % len(curve) * sides + column % sides
    return MeshPart(points.reshape(-1, 3), faces)


def _across(vector: FloatArray, tangent: FloatArray) -> FloatArray:
    """Return the unit vector that is left of one across a tangent."""
    left = vector - (vector @ tangent) * tangent
    return left / np.linalg.norm(left)
