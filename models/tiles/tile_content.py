"""What the content of a tile draws: glTF by itself, batched, instanced, or several in one.

3D Tiles 1.0, "Tile format specifications": ``b3dm``, ``i3dm``, ``pnts``, ``cmpt``; 3D Tiles 1.1:
glTF, binary or as JSON.
"""

import json
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ..gltf.gltf_counts import count_meshes
from ..gltf.gltf_file import parse_glb, parse_gltf
from ..scene.levels import count_rows

_MAX_FILE_BYTES = 256 << 20
_HEADERS = {b"b3dm": 28, b"i3dm": 32, b"pnts": 28}
_MOST_INSTANCES = 10_000_000
_MOST_PARTS = 10_000


def count_content(path: Path) -> FloatArray | None:
    """Return counts in the order of `LEVEL_PREDICTORS`, or None if the content cannot be read.

    Points of a point cloud count as splats, and instances as draws of their model.  A model that an
    instanced content names must lie in its folder.
    """
    if path.stat().st_size > _MAX_FILE_BYTES:
        return None
    try:
        return _count(path.read_bytes(), path.parent)
    except Exception:  # noqa: BLE001 - whatever it is, the content is not read, which is counted
        return None


def _count(data: bytes, folder: Path) -> FloatArray:
    kind = data[:4]
    if kind == b"cmpt":
        return _composite(data, folder)
    if kind == b"glTF":
        return count_meshes(parse_glb(data)[0])
    if kind not in _HEADERS:
        return count_meshes(parse_gltf(data))
    start = _HEADERS[kind]
    if len(data) < start:
        raise InputError("expected a whole header, got fewer bytes")
    sizes = np.frombuffer(data, "<u4", 4, 12).astype(np.int64)
    body = data[start + int(sizes.sum()) :]
    if kind == b"b3dm":
        return _count(body, folder)
    count = _feature_count(data[start : start + int(sizes[0])], kind)
    if kind == b"pnts":
        return count_rows(1, draw_calls=1, splats=count)[0]
    embedded = int(np.frombuffer(data, "<u4", 1, 28)[0]) == 1
    return count * (_count(body, folder) if embedded else _linked(body, folder))


def _feature_count(table: bytes, kind: bytes) -> int:
    """Return how many points or instances a feature table announces."""
    name = "POINTS_LENGTH" if kind == b"pnts" else "INSTANCES_LENGTH"
    count = json.loads(table)[name]
    if not isinstance(count, int) or not 0 <= count <= _MOST_INSTANCES:
        raise InputError(f"{name}: expected 0 to {_MOST_INSTANCES}, got {count!r}")
    return count


def _linked(body: bytes, folder: Path) -> FloatArray:
    """Return the counts of a model beside an instanced content."""
    path = (folder / unquote(body.rstrip(b" \0").decode())).resolve()
    if not path.is_relative_to(folder.resolve()) or path.stat().st_size > _MAX_FILE_BYTES:
        raise InputError("expected a model in the folder of the content, got another")
    data = path.read_bytes()
    if data[:4] in _HEADERS or data[:4] == b"cmpt":
        raise InputError("expected glTF, got a tile")
    return _count(data, folder)


def _composite(data: bytes, folder: Path) -> FloatArray:
    """Return the sum of the counts of a composite's parts; one that cannot be read spoils all."""
    parts = int(np.frombuffer(data, "<u4", 1, 12)[0])
    if not 0 < parts <= _MOST_PARTS:
        raise InputError(f"cmpt: expected 1 to {_MOST_PARTS} parts, got {parts}")
    total, at = None, 16
    for _ in range(parts):
        length = int(np.frombuffer(data, "<u4", 1, at + 8)[0])
        if not 12 <= length <= len(data) - at or data[at : at + 4] == b"cmpt":
            raise InputError("cmpt: expected parts within it, got others")
        counts = _count(data[at : at + length], folder)
        total = counts if total is None else total + counts
        at += length
    assert total is not None
    return total
