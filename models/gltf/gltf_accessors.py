"""Numbers of a glTF file: buffers, buffer views, accessors, compressed or not.

Khronos, "glTF 2.0 specification", section 3.6.
"""

import base64
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .compression import decode_draco, decode_meshopt
from .gltf_schema import Accessor, Document, Primitive, Sparse, pick

MAX_FILE_BYTES = 1 << 30
_MOST_NUMBERS = 100_000_000
"""Of all accessors that are read, however small the file: several may share its bytes."""

_MOST_ZEROS = 1_000_000
"""Elements of an accessor without bytes, of which a file may claim any number."""

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class MissingBufferError(InputError):
    """A buffer is in a file that is not there."""


class Gltf:
    """A document with its buffers."""

    def __init__(self, document: Document, binary: bytes, folder: Path | None) -> None:
        self.document, self._binary, self._folder = document, binary, folder
        self._buffers: dict[int, bytes] = {}
        self._views: dict[int, bytes] = {}
        self._room = _MOST_NUMBERS

    def require_room(self) -> None:
        """Raise `InputError` if all accessors together, read by others, would take too much."""
        for number, accessor in enumerate(self.document.accessors):
            self._take(number, accessor, _SIZES.get(accessor.type, 16))

    def points(self, part: Primitive) -> tuple[FloatArray, NDArray[np.int64], FloatArray | None]:
        """Return positions (n, 3), corners of its primitives, and texture coordinates (n, 2).

        Raises `InputError` if there are none, or as `accessor`.
        """
        draco = part.extensions.draco
        if draco is not None:
            corners, found = decode_draco(self._view(draco.buffer_view), draco.attributes)
            position, uv = found.get("POSITION"), found.get("TEXCOORD_0")
            if position is None or position.shape[1] != 3:
                raise InputError("KHR_draco_mesh_compression: expected positions, got none")
            return position.astype(np.float64), corners, None if uv is None else uv.astype(float)
        position = self.accessor(part.attributes["POSITION"])
        if position.shape[1] != 3:
            raise InputError(f"POSITION: expected 3 numbers, got {position.shape[1]}")
        corners = np.arange(len(position))
        if part.indices is not None:
            corners = self.accessor(part.indices)[:, 0].astype(np.int64)
        number = part.attributes.get("TEXCOORD_0")
        uv = None if number is None else self.accessor(number)
        if uv is not None and uv.shape != (len(position), 2):
            raise InputError(
                f"accessor {number}: expected ({len(position)}, 2) numbers, got {uv.shape}"
            )
        return position, corners, uv

    def accessor(self, number: int) -> FloatArray:
        """Return the elements of an accessor, (count, size), normalised ones within [-1, 1].

        Raises `InputError` if it reaches beyond its buffer, or `MissingBufferError`.
        """
        accessor = pick(self.document.accessors, number, "accessors")
        kind, size = _COMPONENTS.get(accessor.component_type), _SIZES.get(accessor.type)
        if not kind or not size:
            raise InputError(f"accessor {number}: expected numbers or vectors, got another type")
        self._take(number, accessor, size)
        if accessor.buffer_view is None:
            raw: NDArray[Any] = np.zeros((accessor.count, size), kind)
        else:
            raw = self._elements(accessor.buffer_view, accessor.byte_offset, accessor, kind, size)
        if accessor.sparse is not None:
            raw = self._patched(raw.copy(), accessor, accessor.sparse, kind, size)
        values = raw.astype(np.float64)
        if accessor.normalized and raw.dtype.kind in "iu":
            values = np.maximum(values / np.iinfo(raw.dtype).max, -1.0)
        return values

    def _take(self, number: int, accessor: Accessor, size: int) -> None:
        """Count what an accessor takes, before it is read."""
        most = _MOST_ZEROS if accessor.buffer_view is None else _MOST_NUMBERS
        if not 0 < accessor.count <= most:
            raise InputError(
                f"accessor {number}: expected 1 to {most:,} elements, got {accessor.count}"
            )
        self._room -= accessor.count * size
        if self._room < 0:
            message = f"expected at most {_MOST_NUMBERS:,} numbers in accessors, got more"
            raise InputError(f"{message}; split the file")

    def _patched(
        self, raw: NDArray[Any], accessor: Accessor, sparse: Sparse, kind: str, size: int
    ) -> NDArray[Any]:
        part = sparse.indices
        index_kind = _COMPONENTS.get(part.component_type)
        if not index_kind or not 0 < sparse.count <= len(raw):
            raise InputError(f"sparse: expected 1 to {len(raw)} elements, got {sparse.count}")
        few = Accessor(part.component_type, sparse.count, "SCALAR")
        at = self._elements(part.buffer_view, part.byte_offset, few, index_kind, 1)[:, 0]
        if int(at.max()) >= len(raw) or int(at.min()) < 0:
            raise InputError("sparse: expected indices of elements, got others")
        new = Accessor(accessor.component_type, sparse.count, accessor.type)
        values = sparse.values
        raw[at] = self._elements(values.buffer_view, values.byte_offset, new, kind, size)
        return raw

    def _elements(
        self, view_number: int, offset: int, accessor: Accessor, kind: str, size: int
    ) -> NDArray[Any]:
        view = pick(self.document.buffer_views, view_number, "bufferViews")
        data = self._view(view_number)
        item = np.dtype(kind).itemsize * size
        stride = view.byte_stride or item
        end = offset + stride * (accessor.count - 1) + item
        if offset < 0 or stride < item or end > len(data):
            raise InputError(
                f"bufferView {view_number}: expected bytes within its {len(data)}, got {offset} to "
                f"{end}; the file is damaged"
            )
        steps = (stride, np.dtype(kind).itemsize)
        return np.ndarray((accessor.count, size), kind, data, offset=offset, strides=steps)

    def _view(self, number: int) -> bytes:
        """Return the bytes of a buffer view, decompressed."""
        if number not in self._views:
            view = pick(self.document.buffer_views, number, "bufferViews")
            packed = view.extensions.meshopt
            source = view if packed is None else packed
            data = self._stretch(source.buffer, source.byte_offset, source.byte_length)
            self._views[number] = data if packed is None else decode_meshopt(data, packed)
        return self._views[number]

    def _stretch(self, buffer: int, offset: int, length: int) -> bytes:
        if buffer not in self._buffers:
            self._buffers[buffer] = self._load(buffer)
        data = self._buffers[buffer]
        if offset < 0 or length < 0 or offset + length > len(data):
            raise InputError(
                f"buffer {buffer}: expected bytes within its {len(data)}, got {offset} to "
                f"{offset + length}; the file is damaged"
            )
        return data[offset : offset + length]

    def image(self, number: int) -> bytes:
        """Return the bytes of an image; raises InputError, or `MissingBufferError` without it."""
        image = pick(self.document.images, number, "images")
        if image.uri is not None:
            return self._fetch(image.uri, f"image {number}")
        if image.buffer_view is None:
            raise MissingBufferError(f"image {number}: expected a file or a buffer view, got none")
        return self._view(image.buffer_view)

    def _load(self, number: int) -> bytes:
        buffer = pick(self.document.buffers, number, "buffers")
        return self._binary if buffer.uri is None else self._fetch(buffer.uri, f"buffer {number}")

    def _fetch(self, uri: str, what: str) -> bytes:
        """Return the bytes that a URI holds, or the file that it names."""
        head, _, text = uri.partition(",")
        if head.startswith("data:"):
            try:
                return base64.b64decode(text, validate=True)
            except ValueError as error:  # binascii's is one; another tells of other than ASCII
                raise InputError(f"{what}: expected base64, got {error}") from error
        if self._folder is None:
            raise InputError(f"{what}: expected one inside the file, got {uri!r}")
        path = (self._folder / unquote(uri)).resolve()
        if not path.is_relative_to(self._folder.resolve()):
            raise InputError(f"{what}: expected a file in the folder of the glTF, got {uri!r}")
        if not path.is_file():
            raise MissingBufferError("expected a file of the glTF, got no such file", path=path)
        if (size := path.stat().st_size) > MAX_FILE_BYTES:
            raise InputError(f"expected at most 1 GiB, got {size} bytes", path=path)
        return path.read_bytes()
