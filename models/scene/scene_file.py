"""Scene files: one archive, schema ``lodbench.scene/1``, of types, nodes, motion and geometry.

``docs/scenes.md`` lists the arrays.  Geometry is read apart from the scene, as only renderers and
mesh algorithms need it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

from ...base.array_archive import ArrayArchive, write_archive
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ...base.strict_json import decode_json
from ..meshes.geometry import Geometry
from ..meshes.geometry_arrays import pack_geometry, unpack_geometry
from .cells import Cells
from .levels import LevelTable
from .motion import Motion
from .scene import ObjectTypes, Scene

SCHEMA = "lodbench.scene/1"

_HEADER = "scene.json"
_ADVICE = "build the scene with this version"
_MAX_DISTANCE_M = 1e9  # squares and products of four such lengths are still far from overflow
_Arrays: TypeAlias = dict[str, NDArray[Any]]

_NODES: Mapping[str, tuple[type[Any], int]] = {
    "type_index": (np.int32, 1),
    "position_m": (np.float64, 2),
    "orientation_xyzw": (np.float64, 2),
    "scale": (np.float64, 1),
    "importance": (np.float64, 1),
    "parent": (np.int32, 1),
    "additive": (np.bool_, 1),
}
_MOTION: Mapping[str, tuple[type[Any], int]] = {
    "node": (np.int32, 1),
    "radius_m": (np.float64, 1),
    "rate_rad_s": (np.float64, 1),
    "phase_rad": (np.float64, 1),
}
_CELLS: Mapping[str, tuple[type[Any], int]] = {
    "node_cell": (np.int32, 1),
    "low_m": (np.float64, 2),
    "high_m": (np.float64, 2),
    "visible": (np.bool_, 2),
}
_LEVELS: Mapping[str, tuple[type[Any], int]] = {
    "start": (np.int32, 1),
    "error_m": (np.float64, 1),
    "bytes": (np.float64, 1),
    "continuous": (np.bool_, 1),
}


@dataclass(frozen=True, slots=True)
class SceneOrigin:
    """Where a scene comes from: the tool, its inputs without folders, and its options."""

    tool: str = ""
    sources: tuple[str, ...] = ()
    options: Mapping[str, str | float | bool | None] = field(
        default_factory=dict[str, str | float | bool | None]
    )


@dataclass(frozen=True, slots=True)
class _Schema:
    schema: str


@dataclass(frozen=True, slots=True)
class _Header:
    schema: str
    name: str
    types: tuple[str, ...]
    predictors: tuple[str, ...]
    origin: SceneOrigin


def write_scene(
    path: Path, scene: Scene, geometry: Geometry, origin: SceneOrigin | None = None
) -> None:
    """Write a scene and its geometry, which may be empty; the same scene gives the same bytes.

    The cost model that a scene may carry is not part of the file.

    Raises `InputError` if there is geometry that is not one mesh for each row of the level table.
    """
    rows = len(scene.types.levels.error_m)
    if len(geometry) not in (0, rows):
        raise InputError(f"geometry: expected {rows} meshes as levels, got {len(geometry)}")
    header = _Header(
        SCHEMA, scene.name, scene.types.names, LEVEL_PREDICTORS, origin or SceneOrigin()
    )
    arrays: _Arrays = {f"nodes/{name}": getattr(scene, name) for name in _NODES}
    if scene.motion is not None:
        arrays |= {f"motion/{name}": getattr(scene.motion, name) for name in _MOTION}
    if scene.cells is not None:
        arrays |= {f"cells/{name}": getattr(scene.cells, name) for name in _CELLS}
    for name in ("center_m", "radius_m", "disc_share"):
        arrays[f"types/{name}"] = getattr(scene.types, name)
    arrays |= {f"levels/{name}": getattr(scene.types.levels, name) for name in _LEVELS}
    arrays["levels/counts"] = scene.types.levels.counts
    encoded = msgspec.json.format(msgspec.json.encode(header), indent=1)
    write_archive(path, _HEADER, encoded, arrays | pack_geometry(geometry))


def read_scene(path: Path) -> Scene:
    """Read a scene without its geometry.

    Raises `InputError` if the file is missing, damaged, of another schema, or holds values that no
    scene has.
    """
    # Values that overflow are found by the checks, which say it better than a warning.
    with ArrayArchive(path) as archive, np.errstate(over="ignore", invalid="ignore"):
        header = _read_header(archive)
        try:
            return _scene(archive, header)
        except InputError as error:
            raise InputError(error.message, path=path) from error


def read_origin(path: Path) -> SceneOrigin:
    """Read where a scene file comes from; raises InputError as `read_scene`."""
    with ArrayArchive(path) as archive:
        return _read_header(archive).origin


def read_geometry(path: Path) -> Geometry:
    """Read the mesh of each row of the level table, or none if the file has no geometry.

    Raises
    ------
    InputError
        As `read_scene`.
    """
    with ArrayArchive(path) as archive:
        _read_header(archive)
        levels = len(archive.array("levels/error_m", np.float64, 1))
        try:
            return unpack_geometry(archive, levels)
        except InputError as error:
            raise InputError(error.message, path=path) from error


def _read_header(archive: ArrayArchive) -> _Header:
    data = archive.header(_HEADER)
    what = f"a header of {SCHEMA} in {_HEADER}"
    schema = decode_json(data, _Schema, what, _ADVICE, path=archive.path).schema
    if schema != SCHEMA:
        raise InputError(f"expected schema {SCHEMA}, got {schema!r}; {_ADVICE}", path=archive.path)
    return decode_json(data, _Header, what, _ADVICE, path=archive.path)


def _scene(archive: ArrayArchive, header: _Header) -> Scene:
    nodes: dict[str, Any] = {
        name: archive.array(f"nodes/{name}", *kind) for name, kind in _NODES.items()
    }
    motion = None
    if "motion/node" in archive:
        motion = Motion(
            **{name: archive.array(f"motion/{name}", *kind) for name, kind in _MOTION.items()}
        )
    cells = None
    if "cells/node_cell" in archive:
        cells = Cells(
            **{name: archive.array(f"cells/{name}", *kind) for name, kind in _CELLS.items()}
        )
    levels = LevelTable(
        counts=_read_counts(archive, header.predictors),
        **{name: archive.array(f"levels/{name}", *kind) for name, kind in _LEVELS.items()},
    )
    center = archive.array("types/center_m", np.float64, 2)
    radius = archive.array("types/radius_m", np.float64, 1)
    share = np.zeros(0)  # not measured: files of before have none
    if "types/disc_share" in archive:
        share = archive.array("types/disc_share", np.float64, 1)
    types = ObjectTypes(header.types, center, radius, levels, share)
    scene = Scene(name=header.name, types=types, motion=motion, cells=cells, **nodes)
    farthest = max(float(np.abs(scene.center_m).max()), float(scene.radius_m.max()))
    if not farthest <= _MAX_DISTANCE_M:
        raise InputError(f"bounding spheres: expected within 1e9 m, got {farthest:g} m")
    return scene


def _read_counts(archive: ArrayArchive, predictors: tuple[str, ...]) -> NDArray[Any]:
    """Return counts in the order of `LEVEL_PREDICTORS`; those that the file lacks are 0."""
    unknown = sorted(set(predictors) - set(LEVEL_PREDICTORS))
    if unknown or len(set(predictors)) != len(predictors):
        raise InputError(
            f"predictors: expected distinct names among {', '.join(LEVEL_PREDICTORS)}; "
            f"got {', '.join(unknown) or 'a name twice'}"
        )
    given = archive.array("levels/counts", np.float64, 2)
    if given.shape[1] != len(predictors):
        raise InputError(f"level counts: expected {len(predictors)} columns, got {given.shape[1]}")
    counts = np.zeros((len(given), len(LEVEL_PREDICTORS)))
    counts[:, [LEVEL_PREDICTORS.index(name) for name in predictors]] = given
    return counts
