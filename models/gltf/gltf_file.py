"""glTF 2.0 files: the JSON and the buffers behind it.

Khronos, "glTF 2.0 specification", sections 3 (JSON), 4 (GLB).
"""

import base64
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError, about_file
from ...base.files.strict_json import decode_json
from .gltf_schema import Document, pick

_MAX_FILE_BYTES = 1 << 30
_MAX_JSON_BYTES = 64 << 20
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942
_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Gltf:
    """A document with its buffers."""

    def __init__(self, document: Document, binary: bytes, folder: Path | None) -> None:
        self.document, self._binary, self._folder = document, binary, folder
        self._buffers: dict[int, bytes] = {}

    def accessor(self, number: int) -> NDArray[Any]:
        """Return the elements of an accessor, (count, size).

        Raises `InputError` if it is sparse or compressed, or reaches beyond its buffer.
        """
        accessor = pick(self.document.accessors, number, "accessors")
        kind, size = _COMPONENTS.get(accessor.component_type), _SIZES.get(accessor.type)
        if accessor.sparse is not None or accessor.buffer_view is None or not kind or not size:
            raise InputError(
                f"accessor {number}: expected plain numbers in a buffer view, got sparse, "
                "compressed or other ones; export the file without compression"
            )
        view = pick(self.document.buffer_views, accessor.buffer_view, "bufferViews")
        data = self._buffer(view.buffer)
        item = np.dtype(kind).itemsize * size
        stride = view.byte_stride or item
        start = view.byte_offset + accessor.byte_offset
        end = start + stride * (accessor.count - 1) + item
        limit = min(len(data), view.byte_offset + view.byte_length)
        if accessor.count < 1 or start < 0 or stride < item or end > limit:
            raise InputError(
                f"accessor {number}: expected bytes within its buffer of {limit}, got {start} to "
                f"{end}; the file is damaged"
            )
        array: NDArray[Any] = np.ndarray(
            (accessor.count, size),
            kind,
            data,
            offset=start,
            strides=(stride, np.dtype(kind).itemsize),
        )
        return array

    def _buffer(self, number: int) -> bytes:
        if number not in self._buffers:
            self._buffers[number] = self._load(number)
        return self._buffers[number]

    def _load(self, number: int) -> bytes:
        buffer = pick(self.document.buffers, number, "buffers")
        if buffer.uri is None:
            return self._binary
        head, _, text = buffer.uri.partition(",")
        if head.startswith("data:"):
            try:
                return base64.b64decode(text, validate=True)
            except ValueError as error:  # binascii's is one; another tells of other than ASCII
                raise InputError(f"buffer {number}: expected base64, got {error}") from error
        if self._folder is None:
            raise InputError(f"buffer {number}: expected one inside the file, got {buffer.uri!r}")
        path = (self._folder / unquote(buffer.uri)).resolve()
        if not path.is_relative_to(self._folder.resolve()):
            raise InputError(
                f"buffer {number}: expected a file in the folder of the glTF, got {buffer.uri!r}"
            )
        return _read(path)


def read_gltf(path: Path) -> Gltf:
    """Read a ``.gltf`` or ``.glb`` file.

    Raises `InputError` if it is missing, damaged, too large, or not glTF 2.0.
    """
    data = _read(path)
    with about_file(path):
        document, binary = parse_glb(data) if data[:4] == b"glTF" else (_decode(data), b"")
        return Gltf(document, binary, path.parent)


def _read(path: Path) -> bytes:
    if not path.is_file():
        raise InputError("expected a file, got no such file", path=path)
    size = path.stat().st_size
    if size > _MAX_FILE_BYTES:
        raise InputError(f"expected at most 1 GiB, got {size} bytes", path=path)
    return path.read_bytes()


def parse_glb(data: bytes) -> tuple[Document, bytes]:
    """Return the document and the binary chunk of a binary glTF; raises InputError."""
    if len(data) < 20 or data[:4] != b"glTF":
        raise InputError("expected a binary glTF, got other or too few bytes")
    version, length, size, kind = (int(x) for x in np.frombuffer(data, "<u4", 4, 4))
    if version != 2 or length > len(data) or kind != _JSON_CHUNK or 20 + size > length:
        raise InputError(
            f"expected binary glTF 2 of {len(data)} bytes that begins with JSON, got version "
            f"{version} of {length} bytes"
        )
    document = _decode(data[20 : 20 + size])
    rest = data[20 + size : length]
    if len(rest) < 8:
        return document, b""
    size, kind = (int(x) for x in np.frombuffer(rest, "<u4", 2))
    if kind != _BINARY_CHUNK or 8 + size > len(rest):
        raise InputError("expected a binary chunk within the file, got another or a longer one")
    return document, rest[8 : 8 + size]


def _decode(data: bytes) -> Document:
    if len(data) > _MAX_JSON_BYTES:
        raise InputError(f"expected JSON of at most 64 MiB, got {len(data)} bytes")
    document = decode_json(data, Document, "a glTF 2.0 document", "export the file again")
    if not document.asset.version.startswith("2."):
        raise InputError(f"expected glTF 2.0, got version {document.asset.version!r}")
    return document
