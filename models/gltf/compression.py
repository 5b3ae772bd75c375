"""Geometry that glTF files hold compressed: Draco meshes and meshoptimizer's buffers.

Khronos, "KHR_draco_mesh_compression" and "EXT_meshopt_compression", extensions of glTF 2.0.  The
decoders are packages of their own; without one the file is refused by the extension's name, with
the command that decompresses it.
"""

from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from .gltf_schema import MeshoptView

DRACO, MESHOPT = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
_MOST_BYTES = 1 << 28  # of a buffer view once decoded


def _decoder(module: str, extension: str, extra: str) -> Any:
    """Return a module that decodes; raises `InputError` if it is not installed."""
    if find_spec(module) is None:
        raise InputError(
            f"{extension}: expected its decoder, got none; pip install 'lodbench[{extra}]', or "
            "decompress with: npx @gltf-transform/cli copy IN OUT"
        )
    return import_module(module)


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
    decoder = _decoder("DracoPy", DRACO, "draco")
    try:
        mesh: Any = decoder.decode(data)
        found: dict[int, Any] = {}
        for one in mesh.attributes:
            found[one["unique_id"]] = one["data"]
        corners = np.asarray(mesh.faces, dtype=np.int64).ravel()
        parts: dict[str, NDArray[Any]] = {
            name: np.asarray(found[number]) for name, number in attributes.items()
        }
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
    decoder = _decoder("meshoptimizer", MESHOPT, "meshopt")
    stride, count = view.byte_stride, view.count
    if not (0 < stride <= 256 and 0 < count <= _MOST_BYTES // stride):
        expected = f"elements of 1 to 256 bytes, {_MOST_BYTES:,} in all"
        raise InputError(f"{MESHOPT}: expected {expected}, got {count} of {stride}")
    raw = np.frombuffer(data, np.uint8)
    try:
        if view.mode == "ATTRIBUTES":
            plain = decoder.decode_vertex_buffer(count, stride, raw)
            return _filtered(decoder, plain, view)
        triangles = view.mode == "TRIANGLES"
        decode = decoder.decode_index_buffer if triangles else decoder.decode_index_sequence
        # The data do not depend on the size of an index, and the package mixes up short ones.
        corners = np.asarray(decode(count, 4, raw)).ravel()
    except Exception as error:  # the decoder raises bare ones
        raise InputError(f"{MESHOPT}: expected a buffer, got damaged data; export again") from error
    return corners.astype("<u2" if stride == 2 else "<u4").tobytes()


def _filtered(decoder: Any, plain: Any, view: MeshoptView) -> bytes:
    """Return a vertex buffer with the filter undone that it was stored with."""
    data = np.ascontiguousarray(np.asarray(plain)).view(np.uint8).reshape(view.count, -1)
    name = {"OCTAHEDRAL": "oct", "QUATERNION": "quat", "EXPONENTIAL": "exp"}.get(view.filter)
    if name is not None:
        data = getattr(decoder, f"decode_filter_{name}")(data, view.count, view.byte_stride)
    whole: bytes = data.tobytes()
    return whole
