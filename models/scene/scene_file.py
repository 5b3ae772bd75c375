"""Scene files: one archive, schema ``lodbench.scene/1``, of types, nodes, motion and geometry.

``docs/scenes.md`` lists the arrays.  Geometry is read apart from the scene, as only renderers and
mesh algorithms need it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from ...base.arrays import declared_arrays
from ...base.errors import InputError
from ...base.files.array_archive import ArrayArchive, open_archive, write_archive
from ...base.files.strict_json import decode_json
from ...base.predictors import LEVEL_PREDICTORS
from ..meshes.geometry import Geometry
from ..meshes.geometry_arrays import pack_geometry, unpack_geometry
from .cells import Cells
from .levels import LevelTable
from .motion import Motion
from .scene import ObjectTypes, Scene

SCHEMA = "lodbench.scene/1"

_HEADER = "scene.json"
_MEASURED = ("disc_share", "surface_m2", "normal")  # of types, where their meshes are at hand
_ADVICE = "build the scene with this version"
_MAX_DISTANCE_M = 1e9  # squares and products of four such lengths are still far from overflow


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
    groups = {"nodes": scene, "motion": scene.motion, "cells": scene.cells, "types": scene.types}
    arrays = {
        f"{group}/{name}": getattr(struct, name)
        for group, struct in (groups | {"levels": scene.types.levels}).items()
        if struct is not None
        for name in declared_arrays(type(struct))
    }
    arrays["levels/counts"] = arrays.pop("levels/counts")  # last, as ever: equal bytes
    encoded = msgspec.json.format(msgspec.json.encode(header), indent=1)
    write_archive(path, _HEADER, encoded, arrays | pack_geometry(geometry))


def read_scene(path: Path) -> Scene:
    """Read a scene without its geometry.

    Raises `InputError` if the file is missing, damaged, of another schema, or holds values that no
    scene has.
    """
    with open_archive(path) as archive:
        return _scene(archive, _read_header(archive))


def read_origin(path: Path) -> SceneOrigin:
    """Read where a scene file comes from; raises InputError as `read_scene`."""
    with open_archive(path) as archive:
        return _read_header(archive).origin


def read_geometry(path: Path) -> Geometry:
    """Read the mesh of each row of the level table, or none if the file has no geometry.

    Raises `InputError` as `read_scene`.
    """
    with open_archive(path) as archive:
        _read_header(archive)
        return unpack_geometry(archive, len(archive.array("levels/error_m", np.float64, 1)))


def _read_header(archive: ArrayArchive) -> _Header:
    data = archive.header(_HEADER)
    what = f"a header of {SCHEMA} in {_HEADER}"
    schema = decode_json(data, _Schema, what, _ADVICE).schema
    if schema != SCHEMA:
        raise InputError(f"expected schema {SCHEMA}, got {schema!r}; {_ADVICE}")
    return decode_json(data, _Header, what, _ADVICE)


def _scene(archive: ArrayArchive, header: _Header) -> Scene:
    motion = Motion(**_read(archive, "motion", Motion)) if "motion/node" in archive else None
    cells = Cells(**_read(archive, "cells", Cells)) if "cells/node_cell" in archive else None
    counts = _read_counts(archive, header.predictors)
    levels = LevelTable(counts=counts, **_read(archive, "levels", LevelTable, apart=("counts",)))
    # Files of before lack what was not measured then.
    absent = [name for name in _MEASURED if f"types/{name}" not in archive]
    shapes = _read(archive, "types", ObjectTypes, apart=absent)
    types = ObjectTypes(names=header.types, levels=levels, **shapes)
    nodes = _read(archive, "nodes", Scene)
    scene = Scene(name=header.name, types=types, motion=motion, cells=cells, **nodes)
    farthest = max(float(np.abs(scene.center_m).max()), float(scene.radius_m.max()))
    if not farthest <= _MAX_DISTANCE_M:
        raise InputError(f"bounding spheres: expected within 1e9 m, got {farthest:g} m")
    return scene


def _read(
    archive: ArrayArchive, group: str, struct: type[Any], *, apart: Sequence[str] = ()
) -> dict[str, Any]:
    """Return the arrays of a group as a struct declares them, without those read apart."""
    declared = declared_arrays(struct).items()
    return {
        name: archive.array(f"{group}/{name}", dtype, len(shape))
        for name, (dtype, shape) in declared
        if name not in apart
    }


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
