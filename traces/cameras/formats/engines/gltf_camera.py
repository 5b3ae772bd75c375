"""The animated camera of a glTF file: translation and rotation of its node over time.

Khronos, "glTF 2.0 specification", sections 3.10 and 3.11: seconds, OpenGL camera, y up, metres;
linear and stepped samplers, and the values of cubic ones.  Nodes above the camera must not move;
their transform is applied.  Read by trimesh's own loader would lose the animation, so the buffers
are read here.
"""

import base64
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np

from .....base.arrays import FloatArray
from .....base.errors import InputError
from .....base.files.text_file import read_bytes
from ...reading.frames import OPENGL
from ...reading.poses import Poses
from ...reading.rotations import rotations_of
from ...trace_format import TraceFormat, refuse_selector

_FLOAT, _WIDTHS = 5126, {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
_LARGEST_BYTES = 2_000_000_000


def read_gltf_camera(path: Path, selector: str | None = None) -> Poses:
    """Return the poses of the first animated camera; raises `InputError` if there is none."""
    from scipy.spatial.transform import Rotation, Slerp

    refuse_selector(selector, path, "glTF")
    document, chunk = _load(path)
    try:
        node, tracks = _camera_tracks(document, path)
        times = sorted(
            {
                float(t)
                for at, _ in tracks.values()
                for t in _values(document, chunk, at, path)[:, 0]
            }
        )
        time = np.array(times)
        position = np.tile(
            np.array(node.get("translation", (0.0, 0.0, 0.0)), float), (len(time), 1)
        )
        turn = np.tile(np.array(node.get("rotation", (0.0, 0.0, 0.0, 1.0)), float), (len(time), 1))
        if "translation" in tracks:
            at, value = (_values(document, chunk, k, path) for k in tracks["translation"])
            value = _keys(value, len(at))
            position = np.stack([np.interp(time, at[:, 0], value[:, k]) for k in range(3)], axis=1)
        lines = range(1, len(time) + 1)
        rotation = rotations_of(turn, path, list(lines))
        if "rotation" in tracks:
            at, value = (_values(document, chunk, k, path) for k in tracks["rotation"])
            keys = rotations_of(_keys(value, len(at)), path, list(range(1, len(at) + 1)))
            held = np.clip(time, at[0, 0], at[-1, 0])
            if len(at) > 1:
                rotation = Slerp(at[:, 0], Rotation.from_matrix(keys))(held).as_matrix()
            else:
                rotation = np.tile(keys, (len(time), 1, 1))
        camera: dict[str, Any] = document["cameras"][node["camera"]]
    except (KeyError, IndexError, TypeError, ValueError) as error:
        message = "expected a whole glTF animation of a camera, got one with broken references"
        raise InputError(f"{message}; export it again", path=path) from error
    yfov = camera.get("perspective", {}).get("yfov")
    return Poses(
        name=path.stem,
        lines=lines,
        time=time,
        time_unit="s",
        position=position,
        rotation=rotation,
        frame=OPENGL,
        fovy_deg=math.degrees(yfov) if isinstance(yfov, float | int) else None,
        assumed=("nodes above the camera at rest in the origin",),
    )


def _camera_tracks(document: dict[str, Any], path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the first camera's node that moves, and its samplers' accessors by what they move."""
    nodes = document.get("nodes", [])
    for animation in document.get("animations", []):
        found: dict[int, dict[str, Any]] = {}
        for channel in animation["channels"]:
            target = channel["target"]
            sampler = animation["samplers"][channel["sampler"]]
            tracks = found.setdefault(target.get("node", -1), {})
            tracks[target["path"]] = (sampler["input"], sampler["output"])
        for index, tracks in found.items():
            kept = {k: v for k, v in tracks.items() if k in ("translation", "rotation")}
            if index >= 0 and "camera" in nodes[index] and kept:
                return nodes[index], kept
    raise InputError("expected an animated camera, got none; animate the camera's node", path=path)


def _keys(values: FloatArray, count: int) -> FloatArray:
    """Return one value a key: a cubic sampler has tangents before and after each."""
    return values[1::3] if len(values) == 3 * count else values


def _values(document: dict[str, Any], chunk: bytes, index: int, path: Path) -> FloatArray:
    """Return the numbers of an accessor, (n, width)."""
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    width, count = _WIDTHS[accessor["type"]], accessor["count"]
    if accessor["componentType"] != _FLOAT:
        raise InputError(
            "expected float samplers, got others; export without compression", path=path
        )
    data = _buffer(document["buffers"][view["buffer"]], chunk, path)
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", 4 * width)
    if min(start, count, stride) < 0 or start + stride * (count - 1) + 4 * width > len(data):
        raise ValueError("accessor beyond its buffer")
    raw = np.ndarray((count, width), "<f4", data, start, (stride, 4))
    values: FloatArray = raw.astype(np.float64)
    if not np.isfinite(values).all():
        raise InputError("expected finite samplers, got others; export again", path=path)
    return values


def _buffer(buffer: dict[str, Any], chunk: bytes, path: Path) -> bytes:
    uri = buffer.get("uri")
    if uri is None:
        return chunk
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    beside = path.parent / uri
    return read_bytes(beside, _LARGEST_BYTES)


def _load(path: Path) -> tuple[dict[str, Any], bytes]:
    """Return the document and the binary chunk of a .gltf or .glb file."""
    data = read_bytes(path, _LARGEST_BYTES)
    chunk = b""
    try:
        if data[:4] == b"glTF":
            (size,) = struct.unpack_from("<I", data, 12)
            chunk = data[20 + size + 8 :]
            data = data[20 : 20 + size]
        document: Any = json.loads(data)
    except (struct.error, ValueError, RecursionError) as error:
        raise InputError("expected glTF, got a damaged file; export it again", path=path) from error
    if not isinstance(document, dict):
        raise InputError("expected a glTF object, got another; export it again", path=path)
    found: dict[str, Any] = document  # pyright: ignore[reportUnknownVariableType]
    return found, chunk


def _recognises(head: list[str]) -> bool:
    text = " ".join(head)
    return text.startswith("binary glTF") or ('"asset"' in text and '"cameras"' in text)


FORMAT = TraceFormat("animated camera of glTF", _recognises, read_gltf_camera)
