"""Object types with the geometry of their levels, before they stand in a scene."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from ...base.arrays import FloatArray, derive, freeze
from ...base.predictors import LEVEL_PREDICTORS
from ..scene.levels import LevelTable
from ..scene.scene import ObjectTypes
from .geometry import Geometry
from .level_mesh import level_counts, level_mesh
from .mesh_error import ErrorMeter, Sampling
from .silhouette import disc_share
from .surface_mesh import SurfaceMesh


@dataclass(frozen=True, slots=True)
class TypeModel:
    """One type: meshes of L levels, finest first, with their counts and errors.

    Attributes
    ----------
    counts : (L, P) float64
        In the order of `LEVEL_PREDICTORS`.
    error_m : (L,) float64
    continuous : bool
        Whether the levels are knots of a continuous model.
    center_m : (3,) float64
        Derived: centre of the box of all levels.
    radius_m : float
        Derived: radius about the centre that holds every vertex of every level.
    """

    name: str
    meshes: Geometry = field(repr=False)
    counts: Annotated[FloatArray, np.float64, "L", len(LEVEL_PREDICTORS)]
    error_m: Annotated[FloatArray, np.float64, "L"]
    continuous: bool = False
    center_m: FloatArray = field(init=False)
    radius_m: float = field(init=False)

    def __post_init__(self) -> None:
        freeze(self, "type", L=len(self.meshes))
        points = np.concatenate([mesh.vertices for mesh in self.meshes]).astype(np.float64)
        center = (points.min(axis=0) + points.max(axis=0)) / 2.0
        radius = float(np.linalg.norm(points - center, axis=1).max())
        derive(self, center_m=center, radius_m=radius)


def measure_levels(
    levels: Sequence[SurfaceMesh], sampling: Sampling, *, continuous: bool = False
) -> TypeModel:
    """Return the type of a full mesh and its coarser levels, each measured against it.

    An error is raised to that of the finer level where sampling put it below, as policies count on
    errors that never fall.
    """
    full, *coarser = levels
    errors = [0.0]
    if coarser:
        meter = ErrorMeter(full.positions, full.faces, sampling)
        errors += [meter.error_m(level.positions, level.faces) for level in coarser]
    meshes = tuple(level_mesh(level) for level in levels)
    counts = np.stack([level_counts(*pair) for pair in zip(levels, meshes, strict=True)])
    return TypeModel(full.name, meshes, counts, np.maximum.accumulate(errors), continuous)


def gather_types(models: Sequence[TypeModel]) -> tuple[ObjectTypes, Geometry]:
    """Return types and geometry as a scene holds them; names that repeat are numbered."""
    sizes = [len(model.meshes) for model in models]
    geometry = tuple(mesh for model in models for mesh in model.meshes)
    levels = LevelTable(
        start=np.concatenate(([0], np.cumsum(sizes))).astype(np.int32),
        counts=np.concatenate([model.counts for model in models]),
        error_m=np.concatenate([model.error_m for model in models]),
        bytes=np.array([float(mesh.byte_count) for mesh in geometry]),
        continuous=np.array([model.continuous for model in models]),
    )
    center = np.stack([model.center_m for model in models])
    radius = np.array([model.radius_m for model in models])
    names = _numbered([model.name for model in models])
    shares = [disc_share(m.meshes[0], m.center_m, m.radius_m) for m in models]
    return ObjectTypes(names, center, radius, levels, np.array(shares)), geometry


def _numbered(names: Sequence[str]) -> tuple[str, ...]:
    result: dict[str, None] = {}
    following: dict[str, int] = {}  # those below are taken, and stay so
    for name in names:
        new, number = name, following.get(name, 2)
        while new in result:
            new, number = f"{name}-{number}", number + 1
        result[new], following[name] = None, number
    return tuple(result)
