"""Peng's crowd: skinned, textured characters of 1,642 vertices and 2,620 triangles on a square.

Peng, Park and Cao, "A real-time system of crowd rendering", section 5, Table 1.  A character is
continuous; its collapse keeps the seams of the texture and is averaged over the poses of its
motion, as theirs is, and ends at the coarsest that they print, 190 triangles (Fig. 3).  Neither
their mesh nor their motions are public: this is a person of ellipsoids who walks.
"""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..meshes.type_model import TypeModel
from ..scene.scene import Scene
from .scene_registry import BundledScene

SMALLEST_CROWD, LARGEST_CROWD = 32, 32_768
_SEED = 2011
_SPACING_M = 1.5
_SAMPLING = Sampling(vertices=5_000, surface=2_000)
_COARSEST = 190  # Fig. 3; Table 2 has 188.7 triangles a character at 32,768
_POSES = 8  # ours, of one stride
_TEXTURE_BYTES = 1024.0 * 1024.0 * 4.0 * 4.0 / 3.0  # assumed: RGBA8 of 1024 by 1024 with mips


def build_crowd(count: int) -> tuple[Scene, Geometry]:
    """Return `count` characters that stand on a square grid, a little out of line.

    Raises `InputError` if the count is not between 32 and 32,768.
    """
    if not SMALLEST_CROWD <= count <= LARGEST_CROWD:
        sizes = f"{SMALLEST_CROWD} to {LARGEST_CROWD}"
        raise InputError(f"crowd: expected {sizes} characters, got {count}")
    rng = np.random.default_rng(_SEED)
    side = int(np.ceil(np.sqrt(count)))
    row, column = np.divmod(np.arange(count), side)
    plan = _SPACING_M * (np.stack((column, row), axis=1) - (side - 1) / 2.0)
    plan += rng.uniform(-0.3, 0.3, (count, 2))
    yaw = rng.uniform(-np.pi, np.pi, count)
    kind = np.zeros(count, dtype=np.int32)
    return scene_of_objects(f"crowd-{count}", [_character()], kind, plan, yaw, np.ones(count))


@cache
def _character() -> TypeModel:
    mesh = character_mesh()
    surface = OrderedSurface.of(mesh, keep_texture=True, poses=walking_poses(mesh))
    model = build_continuous(surface, KnotOptions(knots=16, min_triangles=_COARSEST), _SAMPLING)
    counts = model.counts.copy()
    vertices = counts[:, LEVEL_PREDICTORS.index("vertices")]
    counts[:, LEVEL_PREDICTORS.index("skinned_vertices")] = vertices
    return replace(model, counts=counts)


def character_mesh() -> SurfaceMesh:
    """Return a person 1.8 m tall in one piece of cloth: body, head, two arms, two legs.

    Each part is closed, with a chart of the texture of its own.  A part of s sides and m rings has
    ``2 s m`` triangles; seams make ``s + seams`` vertices a ring and s at each pole.
    """
    parts = [
        _part(24, 15, 1, (0.0, 0.0, 1.12), (0.24, 0.15, 0.4), (0.0, 0.0)),
        _part(18, 9, 1, (0.0, -0.02, 1.66), (0.11, 0.13, 0.15), (0.5, 0.0)),
        _part(12, 13, 2, (-0.31, 0.0, 1.1), (0.065, 0.075, 0.38), (0.0, 0.5)),
        _part(12, 13, 2, (0.31, 0.0, 1.1), (0.065, 0.075, 0.38), (0.25, 0.5)),
        _part(14, 17, 2, (-0.12, 0.0, 0.44), (0.1, 0.12, 0.45), (0.5, 0.5)),
        _part(14, 17, 2, (0.12, 0.0, 0.44), (0.1, 0.12, 0.45), (0.75, 0.5)),
    ]
    mesh = clean_surface("character", parts, texture_bytes=_TEXTURE_BYTES)
    return mesh.standing(y_up=False, height_m=1.8)


def walking_poses(mesh: SurfaceMesh) -> FloatArray:
    """Return a character's positions at even times of one stride, (8, V, 3).

    Legs swing by 30 degrees and arms by 25 the other way, knees and elbows bend by up to 50.
    """
    # The chart of the texture says which limb a position belongs to.
    u, v = np.zeros((2, len(mesh.positions)))
    u[mesh.faces], v[mesh.faces] = mesh.uv[mesh.uv_index].transpose(2, 0, 1)
    limb = np.where(v >= 0.5, np.floor(4.0 * u).astype(np.int64), -1)
    phase = 2.0 * np.pi * np.arange(_POSES) / _POSES
    poses = np.repeat(mesh.positions[None], _POSES, axis=0)
    limbs = ((0, 25.0, 0.0), (1, 25.0, np.pi), (2, 30.0, np.pi), (3, 30.0, 0.0))
    for number, swing_deg, ahead in limbs:
        at = np.flatnonzero(limb == number)
        height = mesh.positions[at, 2]
        low, top = float(height.min()), float(height.max())
        middle = (low + top) / 2.0
        # The lower half follows its bone, with a joint a fifth of the limb long between the two.
        weight = np.clip((middle - height) / (0.2 * (top - low)) + 0.5, 0.0, 1.0)[:, None]
        side = 1.0 if number < 2 else -1.0  # elbows bend forwards, knees backwards
        for pose, swing in enumerate(np.sin(phase + ahead)):
            points = mesh.positions[at]
            bent = _about_x(points, middle, side * np.radians(25.0 * (1.0 + swing)))
            points = points + weight * (bent - points)
            poses[pose, at] = _about_x(points, top, np.radians(swing_deg * swing))
    return poses


def _about_x(points: FloatArray, height_m: float, angle_rad: float) -> FloatArray:
    """Return points turned about an axis along x at a height, forwards if positive."""
    x, y, z = points.T
    down = z - height_m
    sine, cosine = np.sin(angle_rad), np.cos(angle_rad)
    return np.stack((x, cosine * y + sine * down, height_m - sine * y + cosine * down), axis=1)


def _part(
    sides: int,
    rings: int,
    seams: int,
    center: tuple[float, float, float],
    radii: tuple[float, float, float],
    chart: tuple[float, float],
) -> MeshPart:
    """Return a closed, slightly uneven ellipsoid with its texture seams."""
    column, u = _columns(sides, seams)
    height = np.linspace(0.0, 1.0, rings + 2)
    polar = np.pi * height[1:-1]
    swell = 1.0 + 0.08 * np.cos(3.0 * polar)
    angle = 2.0 * np.pi * (column % sides) / sides  # the last column is the first, to the bit
    across = (np.sin(polar) * swell)[:, None]
    x, y, z = np.broadcast_arrays(
        across * np.cos(angle), across * np.sin(angle), np.cos(polar)[:, None]
    )
    ring = np.stack((x, y, z), axis=2)
    ring_uv = np.stack(np.broadcast_arrays(u[None, :], height[1:-1, None]), axis=2)
    starts = np.flatnonzero(np.diff(column) == 1)  # columns with a next one in the same chart
    poles = np.repeat(((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)), sides, axis=0)
    middle = (u[starts] + u[starts + 1]) / 2.0
    pole_uv = np.stack((np.tile(middle, 2), np.repeat((0.0, 1.0), sides)), axis=1)
    points = np.concatenate((ring.reshape(-1, 3), poles)) * radii + center
    uv = np.concatenate((ring_uv.reshape(-1, 2), pole_uv)) * (0.24, 0.49) + chart
    return MeshPart(points, _part_faces(starts, rings, len(column)), 0, textured=True, uv=uv)


def _columns(sides: int, seams: int) -> tuple[FloatArray, FloatArray]:
    """Return angular steps of the columns of a ring and their u, a column twice at each seam."""
    if seams == 1:
        whole = np.arange(sides + 1.0)
        return whole, whole / sides
    half = sides // 2
    step = np.concatenate((np.arange(half + 1.0), np.arange(half, sides + 1.0)))
    # A gap between the charts, so that the two sides of a seam differ in u.
    u: FloatArray = (step + (np.arange(len(step)) > half)) / (sides + 1.0)
    return step, u


def _part_faces(starts: IntArray, rings: int, width: int) -> NDArray[np.int64]:
    a = (np.arange(rings - 1)[:, None] * width + starts).ravel()
    quads = np.concatenate(
        (np.stack((a, a + width, a + width + 1), 1), np.stack((a, a + width + 1, a + 1), 1))
    )
    first_pole = rings * width + np.arange(len(starts))
    last = (rings - 1) * width + starts
    north = np.stack((first_pole, starts, starts + 1), axis=1)
    south = np.stack((first_pole + len(starts), last + 1, last), axis=1)
    return np.concatenate((quads, north, south)).astype(np.int64)


CROWD = BundledScene(
    "characters of 2,620 triangles, skinned; any number from crowd-32 to crowd-32768",
    lambda: build_crowd(1024),
    build_crowd,
)
