"""A 3D Tiles tileset as a hierarchical scene.

A tile is a node with a type of its own: its bounding sphere, its geometric error, and what its
content draws.  Tiles whose content is missing or of a format that is not read would leave holes:
where a tile above can be drawn instead, that is a leaf of the scene (`tile_holes`); how many
contents and tiles that concerns stands in the origin.  A tileset about the Earth is brought into
the plane that touches it there: x east, y north, z up.
"""

from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ...base.reader_guard import guarded
from ..scene.levels import LevelTable
from ..scene.scene import ObjectTypes, Scene
from ..scene.scene_file import SceneOrigin
from .bounding_volumes import bounding_spheres
from .tile_content import count_content
from .tile_holes import keep_from_holes
from .tile_walk import TileTable, walk_tileset

_EARTH_M = (6_300_000.0, 6_500_000.0)  # distances from the Earth's centre that mean its surface
_MAX_DISTANCE_M = 1e9  # as in scene files
_LEAST_RADIUS_M = 1e-3  # of a volume without extent, so that it has a size at all


def read_tileset(path: Path) -> tuple[Scene, SceneOrigin]:
    """Read a ``tileset.json`` with the tilesets and contents that lie in its folder.

    A `geometricError` that is missing is read as 0.

    Raises `InputError` as `walk_tileset`, or if a volume is out of range.
    """
    with guarded(path, "a 3D Tiles tileset", "export it again"):
        return _read(path)


def _read(path: Path) -> tuple[Scene, SceneOrigin]:
    table = walk_tileset(path)
    transform = np.stack([row.matrix for row in table.rows])
    kinds, numbers = (
        np.array(column) for column in zip(*(r.volume for r in table.rows), strict=True)
    )
    center, radius = bounding_spheres(kinds, numbers, transform)
    farthest = float(np.abs(center).max() + radius.max())
    if not farthest <= _MAX_DISTANCE_M:
        raise InputError(f"bounding volumes: expected within 1e9 m, got {farthest:g} m", path=path)
    error = np.array([row.error for row in table.rows], dtype=np.float64)  # NaN if missing
    # A transform scales errors too (3D Tiles 1.1, section 6.7.4).
    error *= np.linalg.norm(transform[:, :3, :3], axis=1).max(axis=1)
    on_earth = _EARTH_M[0] <= np.linalg.norm(center[0]) <= _EARTH_M[1]
    if on_earth:
        center = _to_tangent_plane(center)
    counts, size, read, absent = _contents(table)
    parent, additive = (
        [getattr(row, name) for row in table.rows] for name in ("parent", "additive")
    )
    solid = counts[:, LEVEL_PREDICTORS.index("triangles")] > 0.0
    files = np.array([len(row.files) for row in table.rows])
    keep = keep_from_holes(parent, additive, solid, read == files, files == 0)
    name = path.parent.resolve().name if path.stem == "tileset" else path.stem
    radius = np.maximum(radius, _LEAST_RADIUS_M)
    types = _types(radius[keep], error[keep], counts[keep], size[keep])
    rows = np.arange(int(np.count_nonzero(keep)))
    # Roots, at -1, stay roots: the last place stands for none.
    place = np.append(np.cumsum(keep) - 1, -1)
    scene = Scene.of(
        name,
        types,
        rows,
        center[keep],
        parent=place[np.array(parent)[keep]],
        additive=np.array(additive)[keep],
    )
    contents = int(files.sum())
    return scene, SceneOrigin(
        "3d-tiles",
        (path.name,),
        {
            "tiles": len(table),
            "tilesets": table.tilesets,
            "contents": contents,
            "contents_read": int(read.sum()),
            "contents_missing": absent,
            "contents_of_other_formats": contents - int(read.sum()) - absent,
            "tiles_left_out": len(table) - len(rows),
            "errors_missing_read_as_0": int(np.isnan(error).sum()),
            "request_volumes_ignored": table.request_volumes,
            "frame": "east-north-up" if on_earth else "as in the file",
        },
    )


def _contents(table: TileTable) -> tuple[FloatArray, FloatArray, IntArray, int]:
    """Return counts (n, P), bytes and contents read (n,) of tiles, and how many are absent."""
    counts, size = np.zeros((len(table), len(LEVEL_PREDICTORS))), np.zeros(len(table))
    known: dict[Path, FloatArray | None] = {}
    read, absent = np.zeros(len(table), dtype=np.int64), 0
    for row, tile in enumerate(table.rows):
        for path in tile.files:
            if path is None:
                absent += 1
                continue
            size[row] += path.stat().st_size
            if path not in known:
                known[path] = count_content(path)
            drawn = known[path]
            if drawn is not None:
                counts[row] += drawn
                read[row] += 1
    return counts, size, read, absent


def _to_tangent_plane(center: FloatArray) -> FloatArray:
    """Return Earth-centred points east, north and up of the first one."""
    up = center[0] / np.linalg.norm(center[0])
    east = np.array((-up[1], up[0], 0.0))
    length = float(np.linalg.norm(east))
    east = east / length if length > 0.0 else np.array((0.0, 1.0, 0.0))  # at a pole
    axes = np.stack((east, np.cross(up, east), up))
    return (center - center[0]) @ axes.T


def _types(
    radius_m: FloatArray, error_m: FloatArray, counts: FloatArray, size: FloatArray
) -> ObjectTypes:
    n = len(radius_m)
    none = np.zeros(n, dtype=np.bool_)
    levels = LevelTable(np.arange(n + 1), counts, np.nan_to_num(error_m), size, none)
    return ObjectTypes(tuple(f"tile-{i}" for i in range(n)), np.zeros((n, 3)), radius_m, levels)
