"""Measurements of continuous models on real meshes, as the manual prints them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from index_set import ExtractionWork, IndexSet
from texture_meter import TextureMeter

from lodbench.base.arrays import FloatArray
from lodbench.models.continuous.knots import OrderedSurface
from lodbench.models.continuous.ordered_mesh import OrderedMesh, overhead_from
from lodbench.models.meshes.mesh_error import ErrorMeter, Sampling
from lodbench.models.meshes.simplify import simplify_surface
from lodbench.models.meshes.surface_mesh import SurfaceMesh

_VERTEX_BYTES = 24  # position and normal, float32
_TRIANGLE_BYTES = 12


@dataclass(frozen=True, slots=True)
class Memory:
    """Bytes that a renderer keeps of a mesh with position and normal, 32 bits a number.

    Attributes
    ----------
    single : the mesh at one resolution, vertices and indices
    substitutes : beside it, the substitute of each vertex
    counts : triangles and vertices after each step
    restarts : the restart lists
    levels : instead of all three, discrete levels of half the triangles each, down to 32
    """

    single: int
    substitutes: int
    counts: int
    restarts: int
    levels: int


@dataclass(frozen=True, slots=True)
class CollapseError:
    """Greatest and mean distance from the full mesh over those of fast-simplification's mesh."""

    triangles: int
    greatest: float
    mean: float


@dataclass(frozen=True, slots=True)
class TextureError:
    """Mean distance in texture space at one number of triangles."""

    triangles: int
    kept: float
    plain: float


def memory_of(ordered: OrderedMesh) -> Memory:
    """Return what an ordered mesh takes; bytes counted as stored."""
    full = int(ordered.faces_after[0])
    ratio = int(ordered.vertices_after[0]) / full
    levels = [full >> i for i in range(1, 32) if full >> i >= 32]
    return Memory(
        _VERTEX_BYTES * int(ordered.vertices_after[0]) + _TRIANGLE_BYTES * full,
        ordered.target.nbytes,
        ordered.vertices_after.nbytes + ordered.faces_after.nbytes,
        sum(restart.faces.nbytes for restart in ordered.restarts[1:]),
        sum(round(count * (_VERTEX_BYTES * ratio + _TRIANGLE_BYTES)) for count in levels),
    )


def traversal_overhead(mesh: OrderedMesh) -> FloatArray:
    """Return extra vertices visited over corners drawn, after each number of steps, (S + 1,).

    A chain of k substitutions visits k vertices besides the one that is drawn.
    """
    result = np.empty(mesh.steps + 1)
    ends = [*(restart.step for restart in mesh.restarts[1:]), mesh.steps + 1]
    for restart, end in zip(mesh.restarts, ends, strict=True):
        ratio = overhead_from(restart, mesh.target, mesh.vertices_after, mesh.faces_after)
        result[restart.step : end] = ratio[: end - restart.step]
    return result


def overhead_at(ordered: OrderedMesh, resolutions: Sequence[float]) -> list[float]:
    """Return the traversal overhead at shares of the full triangle count."""
    full, overhead = int(ordered.faces_after[0]), traversal_overhead(ordered)
    return [float(overhead[ordered.step_of(round(share * full))]) for share in resolutions]


def extraction_work(ordered: OrderedMesh, before: float, after: float) -> ExtractionWork:
    """Return the operations that bring an index set from one resolution to another."""
    full, indices = int(ordered.faces_after[0]), IndexSet(ordered)
    indices.change(round(before * full))
    return indices.change(round(after * full))


def collapse_errors(
    surface: OrderedSurface, resolutions: Sequence[float], sampling: Sampling
) -> list[CollapseError]:
    """Return errors over those of fast-simplification at equal triangles, measured alike.

    Where it stops above a resolution, the number of triangles that it stops at counts, once.
    """
    mesh, result = surface.full, list[CollapseError]()
    meter = ErrorMeter(mesh.positions, mesh.faces, sampling)
    for share in resolutions:
        target = round(share * len(mesh.faces))
        positions, faces = simplify_surface(mesh.positions, mesh.faces, target)
        if any(row.triangles == len(faces) for row in result):
            continue
        theirs = meter.distances_m(positions, faces)
        rows = surface.ordered.extract(len(faces))
        ours = meter.distances_m(mesh.positions, surface.ordered.vertex_source[rows])
        greatest, mean = np.divide(ours, theirs)
        result.append(CollapseError(len(faces), float(greatest), float(mean)))
    return result


def texture_errors(mesh: SurfaceMesh, resolutions: Sequence[float]) -> list[TextureError]:
    """Return errors of the collapse that keeps texture and of the plain one, at equal triangles.

    Coordinates of the plain collapse are carried over by nearest corners.  Resolutions below what
    the fixed vertices allow are left out.
    """
    meter, result = TextureMeter(mesh), list[TextureError]()
    kept, plain = (OrderedSurface.of(mesh, keep_texture=keep) for keep in (True, False))
    for share in resolutions:
        count = round(share * len(mesh.faces))
        if count >= kept.ordered.faces_after[-1]:
            errors = [_texture_error(meter, surface, count) for surface in (kept, plain)]
            result.append(TextureError(count, *errors))
    return result


def _texture_error(meter: TextureMeter, surface: OrderedSurface, triangles: int) -> float:
    faces, part, uv_index = surface.extract(triangles)
    return meter.error_uv(surface.full.positions, faces, part, uv_index)
