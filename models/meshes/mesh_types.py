"""Object types from mesh files."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...base.errors import InputError
from ...base.reader_guard import guarded
from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from .authored_levels import MeshGroup
from .mesh_error import Sampling
from .mesh_file import load_levels, load_mesh
from .simplify import ChainOptions, build_chain
from .surface_mesh import Stand, SurfaceMesh
from .type_model import TypeModel, measure_levels

_WHAT, _ADVICE = "a mesh of which levels can be made", "look at it in a modelling tool"


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
    keep_origin : bool
        Whether the file's origin stays that of the type, as placements from an engine need it; else
        the type stands on its box.
    """

    up: str = "y"
    height_m: float = 2.0
    unit_m: float | None = None
    keep_origin: bool = False

    def __post_init__(self) -> None:
        if self.up not in ("y", "z"):
            raise InputError(f"up axis: expected y or z, got {self.up}")
        for name, value in (("height", self.height_m), ("unit", self.unit_m)):
            if value is not None and not (np.isfinite(value) and 0.0 < value <= 1e6):
                raise InputError(f"{name}: expected metres above 0 to 1e6, got {value}")


def read_surface(path: Path, units: MeshUnits) -> SurfaceMesh:
    """Return the mesh of a file in metres, z up, standing on the ground; raises InputError."""
    mesh = load_mesh(path)
    with guarded(path, _WHAT, _ADVICE):
        return mesh.at(_stand(mesh, units))


def _stand(mesh: SurfaceMesh, units: MeshUnits) -> Stand:
    return mesh.stand(
        y_up=units.up == "y",
        height_m=units.height_m if units.unit_m is None else None,
        unit_m=units.unit_m or 1.0,
        keep_origin=units.keep_origin,
    )


def read_types(
    groups: Iterable[MeshGroup],
    units: MeshUnits,
    detail: ChainOptions | KnotOptions,
    sampling: Sampling,
) -> Iterator[TypeModel]:
    """Yield a type with its measured levels for each group of mesh files, in order.

    A group of several files has these as its levels, and a glTF file with levels has its own; they
    all stand as the finest does.

    Raises `InputError` if a mesh is refused, with its path, or a level has not fewer triangles than
    the finer one.

    Parameters
    ----------
    detail : a chain of discrete levels, or the knots of a continuous type, of what has no levels
    """
    for group in groups:
        with guarded(group.paths[0], _WHAT, _ADVICE):
            model = _read_type(group, units, detail, sampling)
        yield model


def _read_type(
    group: MeshGroup, units: MeshUnits, detail: ChainOptions | KnotOptions, sampling: Sampling
) -> TypeModel:
    first, *coarser = group.paths
    meshes = [(first, mesh) for mesh in (load_levels(first) if not coarser else [load_mesh(first)])]
    meshes += [(path, load_mesh(path)) for path in coarser]
    stand = _stand(meshes[0][1], units)
    if len(meshes) > 1:
        return _authored(group.name, meshes, stand, sampling)
    standing = meshes[0][1].at(stand)
    if isinstance(detail, ChainOptions):
        return build_chain(standing, detail, sampling)
    surface = OrderedSurface.of(standing, keep_texture=detail.keep_texture)
    return build_continuous(surface, detail, sampling)


def _authored(
    name: str, meshes: Sequence[tuple[Path, SurfaceMesh]], stand: Stand, sampling: Sampling
) -> TypeModel:
    """Return a type of levels from files, finest first."""
    levels = [replace(mesh.at(stand), name=name) for _, mesh in meshes]
    for number, (finer, coarser) in enumerate(pairwise(levels), 1):
        if len(coarser.faces) >= len(finer.faces):
            raise InputError(
                f"expected fewer than the {len(finer.faces):,} triangles of level {number - 1}, "
                f"got {len(coarser.faces):,}; check the order of the levels",
                path=meshes[number][0],
            )
    return measure_levels(levels, sampling)
