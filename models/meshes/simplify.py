"""Chains of discrete levels of detail, by quadric edge collapse."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import require_between
from .attributes import carry
from .mesh_error import Sampling
from .surface_mesh import SurfaceMesh
from .type_model import TypeModel, measure_levels


@dataclass(frozen=True, slots=True)
class ChainOptions:
    """How many levels a chain has; level i aims at ``ratio ** i`` of the full triangles.

    Attributes
    ----------
    levels : int
        At most, the full mesh included; 1 to 32.
    ratio : float
        Triangles of a level over triangles of the finer one, in [0.05, 0.95].
    min_triangles : int
        No level aims lower.
    """

    levels: int = 8
    ratio: float = 0.5
    min_triangles: int = 32

    def __post_init__(self) -> None:
        require_between(self.levels, 1, 32, "levels")
        require_between(self.ratio, 0.05, 0.95, "ratio")
        require_between(self.min_triangles, 1, np.inf, "min_triangles")


def build_chain(full: SurfaceMesh, options: ChainOptions, sampling: Sampling) -> TypeModel:
    """Return the levels of a mesh, each collapsed from the full mesh and measured against it.

    The chain ends where the next target is below `min_triangles`, or where simplification stops
    removing triangles (a level must have at most 0.95 of the finer one's).
    """
    levels = [full]
    for level in range(1, options.levels):
        target = round(len(full.faces) * options.ratio**level)
        if target < options.min_triangles:
            break
        positions, faces = simplify_surface(full.positions, full.faces, target)
        if not 0 < len(faces) <= 0.95 * len(levels[-1].faces):
            break
        levels.append(carry(full, positions, faces))
    return measure_levels(levels, sampling)


def simplify_surface(
    positions: FloatArray, faces: IntArray, target: int
) -> tuple[FloatArray, IntArray]:
    """Return positions and faces of at least about `target` triangles (fast-simplification).

    The method is Garland and Heckbert, "Surface simplification using quadric error metrics"
    (1997), with the threshold schedule of Forstmann's Fast Quadric Mesh Simplification.
    """
    import fast_simplification

    if target >= len(faces):
        return positions, faces
    # The schedule's thresholds are absolute, so the mesh is brought to unit size for them.
    low = positions.min(axis=0)
    size = float(np.ptp(positions, axis=0).max())
    unit = (positions - low) / size
    # The library takes writable arrays only.
    triangles: Any = faces.copy()
    result: Any = fast_simplification.simplify(unit, triangles, target_count=target)
    points = np.asarray(result[0], dtype=np.float64) * size + low
    simple = np.asarray(result[1], dtype=np.int32)
    a, b, c = (points[simple[:, i]] for i in range(3))
    keep = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12 * size * size
    return points, simple[keep]
