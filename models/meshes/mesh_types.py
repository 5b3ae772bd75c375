"""Object types from mesh files."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...base.errors import InputError, about_file
from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from .mesh_error import Sampling
from .mesh_file import load_mesh
from .simplify import ChainOptions, build_chain
from .surface_mesh import SurfaceMesh
from .type_model import TypeModel


@dataclass(frozen=True, slots=True)
class MeshUnits:
    """How a file's axes and units become metres, z up.

    Attributes
    ----------
    up : "y" or "z"
    height_m : float
        Height that each type is scaled to, as most formats state no unit.
    unit_m : float, optional
        Metres of one file unit; given, it replaces the height.
    """

    up: str = "y"
    height_m: float = 2.0
    unit_m: float | None = None

    def __post_init__(self) -> None:
        if self.up not in ("y", "z"):
            raise InputError(f"up axis: expected y or z, got {self.up}")
        for name, value in (("height", self.height_m), ("unit", self.unit_m)):
            if value is not None and not (np.isfinite(value) and 0.0 < value <= 1e6):
                raise InputError(f"{name}: expected metres above 0 to 1e6, got {value}")


def read_surface(path: Path, units: MeshUnits) -> SurfaceMesh:
    """Return the mesh of a file in metres, z up, standing on the ground; raises InputError."""
    mesh = load_mesh(path)
    height = units.height_m if units.unit_m is None else None
    with about_file(path):
        return mesh.standing(y_up=units.up == "y", height_m=height, unit_m=units.unit_m or 1.0)


def read_types(
    paths: Iterable[Path],
    units: MeshUnits,
    detail: ChainOptions | KnotOptions,
    sampling: Sampling,
) -> Iterator[TypeModel]:
    """Yield a type with its measured levels for each mesh file, in order.

    Raises `InputError` if a mesh is refused, with its path.

    Parameters
    ----------
    detail : a chain of discrete levels, or the knots of a continuous type
    """
    for path in paths:
        standing = read_surface(path, units)
        if isinstance(detail, ChainOptions):
            yield build_chain(standing, detail, sampling)
        else:
            surface = OrderedSurface.of(standing, keep_texture=detail.keep_texture)
            yield build_continuous(surface, detail, sampling)
