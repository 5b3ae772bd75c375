"""Parts of the detector: coils, modules, chambers, wheels, pipes."""

import numpy as np

from ....base.arrays import FloatArray
from ...meshes.shapes import grid_faces, move_part, revolved, rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface

COIL, WEDGE, CHAMBER, WHEEL, LAYER, FLANGE, PIPE, FOOT = range(8)
"""Places in what `make_parts` returns."""


def make_parts(rng: np.random.Generator) -> list[SurfaceMesh]:
    """Return the distinct parts, in metres, each about its own origin."""
    parts: list[tuple[str, list[MeshPart]]] = [
        ("coil", [_coil()]),
        ("calorimeter-wedge", [_wedge(rng)]),
        ("muon-chamber", [_chamber(rng)]),
        ("wheel", [_wheel()]),
        ("inner-layer", [_layer()]),
        ("flange", [_flange()]),
        ("pipe", [_pipe()]),
        ("foot", _foot(rng)),
    ]
    return [clean_surface(name, meshes) for name, meshes in parts]


def _coil() -> MeshPart:
    """Return a coil in the plane of the beam, 25 m long and 5 m high: a bent, ribbed tube."""
    t = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]
    # A superellipse of exponent 5: a racetrack with round corners.
    x, z = (np.sign(f(t)) * np.abs(f(t)) ** 0.4 for f in (np.cos, np.sin))
    path = np.stack((12.0 * x, np.zeros_like(x), 2.2 * z), axis=1)
    return _tube(path, 0.5 + 0.04 * np.cos(12.0 * t), 32)


def _tube(path: FloatArray, radius: FloatArray, sides: int) -> MeshPart:
    """Return a closed tube about a closed path in the plane y = 0."""
    ahead = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    up = np.array((0.0, 1.0, 0.0))
    out = np.cross(ahead, up)
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    ring = np.cos(angle)[None, :, None] * out[:, None] + np.sin(angle)[None, :, None] * up
    points = path[:, None] + radius[:, None, None] * ring
    rows = len(path)
    row, column = np.divmod(grid_faces(rows, sides), sides + 1)
    faces = (row % rows) * sides + column % sides
    return MeshPart(points.reshape(-1, 3), faces)


def _wedge(rng: np.random.Generator) -> MeshPart:
    """Return a module of the calorimeter, 4.2 m along the beam, wider outward."""
    box = rough_box(rng, 24)
    points = box.vertices * (4.2, 0.28, 1.6)
    points[:, 1] *= 1.0 + 0.25 * points[:, 2]
    return MeshPart(points, box.faces)


def _chamber(rng: np.random.Generator) -> MeshPart:
    """Return a muon chamber of 2.4 by 1.9 m, its tubes as ridges."""
    box = rough_box(rng, 20)
    points = box.vertices * (2.4, 1.9, 0.3)
    points[:, 2] += 0.03 * np.sin(40.0 * points[:, 1]) * np.sign(points[:, 2])
    return MeshPart(points, box.faces)


def _wheel() -> MeshPart:
    """Return a wheel across the beam, 24 m in diameter, of rings that stand out."""
    radius = np.concatenate((np.linspace(1.0, 12.0, 40), np.linspace(12.0, 1.0, 40)))
    thick = 0.2 + 0.08 * (np.arange(80) // 4 % 2)
    height = np.where(np.arange(80) < 40, thick, -thick)
    return _along_beam(revolved(list(zip(height, radius, strict=True)), 64))


def _layer() -> MeshPart:
    """Return a barrel about the beam, 6.8 m long and 2.4 m in diameter, ribbed."""
    height = np.linspace(-3.4, 3.4, 49)
    radius = 1.2 + 0.02 * np.cos(24.0 * height)
    return _along_beam(revolved(list(zip(height, radius, strict=True)), 72))


def _along_beam(part: MeshPart) -> MeshPart:
    """Return a part with its z axis turned to x."""
    x, y, z = part.vertices.T
    return MeshPart(np.stack((z, y, -x), axis=1), part.faces)


def _flange() -> MeshPart:
    """Return a flange with its pipe's end, 1 m across."""
    profile = [(0.0, 0.2), (0.0, 0.5), (0.1, 0.5), (0.1, 0.3), (0.15, 0.22), (0.8, 0.2)]
    return revolved(profile, 32)


def _pipe() -> MeshPart:
    """Return a pipe along the beam, 3.6 m long, with two collars."""
    height = np.linspace(-1.8, 1.8, 25)
    radius = 0.07 + 0.05 * (np.abs(np.abs(height) - 1.2) < 0.1)
    return _along_beam(revolved(list(zip(height, radius, strict=True)), 16))


def _foot(rng: np.random.Generator) -> list[MeshPart]:
    """Return a foot of the structure: a plate on two pillars."""
    plate = move_part(rough_box(rng, 14), (0.0, 0.0, 0.0), (2.2, 3.0, 0.6))
    pillars = [move_part(rough_box(rng, 10), (x, 0.0, 1.2), (0.5, 1.2, 2.0)) for x in (-0.7, 0.7)]
    return [plate, *pillars]
