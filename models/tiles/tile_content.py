"""What the content of a tile draws: batched and binary glTF, told from other formats."""

from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ..gltf.gltf_counts import count_meshes
from ..gltf.gltf_file import parse_glb

_MAX_FILE_BYTES = 256 << 20
_B3DM_HEADER = 28


def count_content(path: Path) -> FloatArray | None:
    """Return counts in the order of `LEVEL_PREDICTORS`, or None if the content cannot be read.

    Read are ``b3dm`` and ``glb`` that hold glTF 2.0.  Point clouds, instanced and composite models
    and damaged files are not.
    """
    if path.stat().st_size > _MAX_FILE_BYTES:
        return None
    data = path.read_bytes()
    if data[:4] == b"b3dm" and len(data) >= _B3DM_HEADER:
        sizes = np.frombuffer(data, "<u4", 4, 12).astype(np.int64)
        data = data[_B3DM_HEADER + int(sizes.sum()) :]
    try:
        return count_meshes(parse_glb(data)[0])
    except InputError:
        return None
