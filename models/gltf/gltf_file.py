"""glTF 2.0 files: the JSON, in a file of its own or in a binary one.

Khronos, "glTF 2.0 specification", sections 3 (JSON), 4 (GLB).
"""

from pathlib import Path

import numpy as np

from ...base.errors import InputError
from ...base.files.strict_json import decode_json
from ...base.reader_guard import guarded
from .gltf_accessors import MAX_FILE_BYTES, Gltf
from .gltf_schema import Document

_MAX_JSON_BYTES = 64 << 20
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read_gltf(path: Path) -> Gltf:
    """Read a ``.gltf`` or ``.glb`` file.

    Raises `InputError` if it is missing, damaged, too large, or not glTF 2.0.
    """
    with guarded(path, "a glTF 2.0 file", "export it again"):
        data = _read(path)
        document, binary = parse_glb(data) if data[:4] == b"glTF" else (parse_gltf(data), b"")
        return Gltf(document, binary, path.parent)


def _read(path: Path) -> bytes:
    if not path.is_file():
        raise InputError("expected a file, got no such file", path=path)
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
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
    document = parse_gltf(data[20 : 20 + size])
    rest = data[20 + size : length]
    if len(rest) < 8:
        return document, b""
    size, kind = (int(x) for x in np.frombuffer(rest, "<u4", 2))
    if kind != _BINARY_CHUNK or 8 + size > len(rest):
        raise InputError("expected a binary chunk within the file, got another or a longer one")
    return document, rest[8 : 8 + size]


def parse_gltf(data: bytes) -> Document:
    """Return a document of JSON; raises `InputError` if it is not of glTF 2.0."""
    if len(data) > _MAX_JSON_BYTES:
        raise InputError(f"expected JSON of at most 64 MiB, got {len(data)} bytes")
    document = decode_json(data, Document, "a glTF 2.0 document", "export the file again")
    if not document.asset.version.startswith("2."):
        raise InputError(f"expected glTF 2.0, got version {document.asset.version!r}")
    return document
