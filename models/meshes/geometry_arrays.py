"""Geometry as a few long arrays, as scene files hold it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.files.array_archive import ArrayArchive
from .geometry import Geometry, LevelMesh


def pack_geometry(geometry: Geometry) -> dict[str, NDArray[Any]]:
    """Return the meshes as concatenated arrays with the row at which each mesh starts; or none."""
    if not geometry:
        return {}
    with_uv = [mesh.uv for mesh in geometry if mesh.uv is not None]
    return {
        "geometry/vertex_start": _starts([len(mesh.vertices) for mesh in geometry]),
        "geometry/vertices": np.concatenate([mesh.vertices for mesh in geometry]),
        "geometry/normals": np.concatenate([mesh.normals for mesh in geometry]),
        "geometry/face_start": _starts([len(mesh.faces) for mesh in geometry]),
        "geometry/faces": np.concatenate([mesh.faces for mesh in geometry]),
        "geometry/part_rows": _starts([len(mesh.part_start) for mesh in geometry]),
        "geometry/part_start": np.concatenate([mesh.part_start for mesh in geometry]),
        "geometry/has_uv": np.array([mesh.uv is not None for mesh in geometry]),
        "geometry/uv": np.concatenate((np.zeros((0, 2), dtype=np.float32), *with_uv)),
    }


def _starts(lengths: list[int]) -> NDArray[np.int64]:
    return np.concatenate(([0], np.cumsum(lengths, dtype=np.int64))).astype(np.int64)


def unpack_geometry(archive: ArrayArchive, levels: int) -> Geometry:
    """Return the meshes of an archive, one for each level; nothing if it has no geometry.

    Raises `InputError` if an array is missing or damaged, or an index or a row is out of range.
    """
    if "geometry/vertex_start" not in archive:
        return ()
    vertices = _split(archive, "vertices", "vertex_start", np.float32, levels)
    normals = _split(archive, "normals", "vertex_start", np.float32, levels)
    faces = _split(archive, "faces", "face_start", np.int32, levels)
    parts = _split(archive, "part_start", "part_rows", np.int32, levels, dimensions=1)
    has_uv = archive.array("geometry/has_uv", np.bool_, 1)
    if len(has_uv) != levels:
        raise InputError(f"geometry has_uv: expected {levels} flags, got {len(has_uv)}")
    ends = np.cumsum([len(v) * flag for v, flag in zip(vertices, has_uv, strict=True)])
    uv = np.split(archive.array("geometry/uv", np.float32, 2), ends[:-1])
    rows = zip(vertices, normals, faces, parts, uv, has_uv, strict=True)
    return tuple(LevelMesh(*level, uv=own if flag else None) for *level, own, flag in rows)


def _split(
    archive: ArrayArchive,
    name: str,
    starts: str,
    dtype: type[Any],
    levels: int,
    *,
    dimensions: int = 2,
) -> list[NDArray[Any]]:
    """Return the rows of each level."""
    array = archive.array(f"geometry/{name}", dtype, dimensions)
    start, rows = archive.array(f"geometry/{starts}", np.int64, 1), len(array)
    if len(start) != levels + 1 or start[0] != 0 or start[-1] != rows or (np.diff(start) < 0).any():
        raise InputError(f"geometry {starts}: expected {levels + 1} rows rising from 0 to {rows}")
    return np.split(array, start[1:-1])
