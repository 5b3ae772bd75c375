"""Geometry that glTF files hold compressed: Draco meshes and meshoptimizer's buffers.

Khronos, "KHR_draco_mesh_compression" and "EXT_meshopt_compression", extensions of glTF 2.0.  The
decoders are packages of their own; without one the file is refused by the extension's name, with
the command that decompresses it.
"""

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from .gltf_schema import MeshoptView

DRACO, MESHOPT = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
_MOST_ELEMENTS = 50_000_000


def _require(module: str, extension: str, extra: str) -> None:
    if find_spec(module) is None:
        raise InputError(
            f"{extension}: expected its decoder, got none; pip install 'lodbench[{extra}]', or "
            "decompress with: npx @gltf-transform/cli copy IN OUT"
        )


def decode_draco(
    data: bytes, attributes: Mapping[str, int]
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Return corners (3 f,) and attributes (n, k) by name of a Draco mesh.

    Raises `InputError` without the decoder, or if the data are damaged.

    Parameters
    ----------
    attributes
        Draco's ids of the attributes, by glTF's names.
    """
    _require("DracoPy", DRACO, "draco")
    import DracoPy

    try:
        mesh: Any = DracoPy.decode(data)
        found: dict[int, Any] = {one["unique_id"]: one["data"] for one in mesh.attributes}
        corners = np.asarray(mesh.faces, dtype=np.int64).ravel()
        parts = {name: np.asarray(found[number]) for name, number in attributes.items()}
    except Exception as error:  # the decoder raises bare ones
        raise InputError(f"{DRACO}: expected a mesh, got damaged data; export again") from error
    for name, values in parts.items():
        if values.ndim != 2 or (corners.size and corners.max() >= len(values)):
            raise InputError(f"{DRACO}: expected {name} of every vertex, got fewer; export again")
    return corners, parts


def decode_meshopt(data: bytes, view: MeshoptView) -> bytes:
    """Return the bytes of a buffer view that meshoptimizer compressed.

    Raises `InputError` without the decoder, or if the data are damaged.
    """
    _require("meshoptimizer", MESHOPT, "meshopt")
    import meshoptimizer

    stride, count = view.byte_stride, view.count
    if not (0 < stride <= 256 and 0 < count <= _MOST_ELEMENTS):
        raise InputError(f"{MESHOPT}: expected elements of 1 to 256 bytes, got {count} of {stride}")
    raw = np.frombuffer(data, np.uint8)
    try:
        if view.mode == "ATTRIBUTES":
            plain = meshoptimizer.decode_vertex_buffer(count, stride, raw)
            return _filtered(plain, view)
        triangles = view.mode == "TRIANGLES"
        decode: Any = (
            meshoptimizer.decode_index_buffer if triangles else meshoptimizer.decode_index_sequence
        )
        # The data do not depend on the size of an index, and the package mixes up short ones.
        corners = np.asarray(decode(count, 4, raw)).ravel()
    except Exception as error:  # the decoder raises bare ones
        raise InputError(f"{MESHOPT}: expected a buffer, got damaged data; export again") from error
    return corners.astype("<u2" if stride == 2 else "<u4").tobytes()


def _filtered(plain: Any, view: MeshoptView) -> bytes:
    """Return a vertex buffer with the filter undone that it was stored with."""
    import meshoptimizer

    data = np.ascontiguousarray(np.asarray(plain)).view(np.uint8).reshape(view.count, -1)
    name = {"OCTAHEDRAL": "oct", "QUATERNION": "quat", "EXPONENTIAL": "exp"}.get(view.filter)
    if name is not None:
        undo: Any = getattr(meshoptimizer, f"decode_filter_{name}")
        done: Any = undo(data, view.count, view.byte_stride)
        data = data if done is None else np.asarray(done)
    return data.tobytes()
