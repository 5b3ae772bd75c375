"""glTF 2.0 documents: the JSON, the buffers behind it, and what its meshes count.

Khronos, "glTF 2.0 specification", sections 3 (JSON), 4 (GLB).
"""

import base64
import binascii
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import msgspec
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .arrays import FloatArray
from .predictors import LEVEL_PREDICTORS

__all__ = ["Document", "Gltf", "Node", "Primitive", "count_meshes", "parse_glb", "read_gltf"]

_MAX_FILE_BYTES = 1 << 30
_MAX_JSON_BYTES = 64 << 20
_MAX_NODES = 1_000_000
_MAX_COUNT = 1 << 31
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942
_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


class _Struct(msgspec.Struct, frozen=True, rename="camel"):
    """Members that are not named here are skipped."""


class _Present(_Struct, frozen=True):
    """An object of which only the presence matters."""


class _Lod(_Struct, frozen=True):
    ids: list[int]


class _NodeExtensions(msgspec.Struct, frozen=True):
    MSFT_lod: _Lod | None = None


class Node(_Struct, frozen=True):
    """A node: its mesh, its children, where it stands, and its coarser levels."""

    mesh: int | None = None
    children: list[int] = []
    matrix: tuple[float, ...] | None = None
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    extensions: _NodeExtensions = _NodeExtensions()
    name: str = ""


class Primitive(_Struct, frozen=True):
    """Part of a mesh that is drawn by one call."""

    attributes: dict[str, int]
    indices: int | None = None
    material: int | None = None
    mode: int = _TRIANGLES


class _Mesh(_Struct, frozen=True):
    primitives: list[Primitive]
    name: str = ""


class _Accessor(_Struct, frozen=True):
    component_type: int
    count: int
    type: str
    buffer_view: int | None = None
    byte_offset: int = 0
    sparse: _Present | None = None


class _View(_Struct, frozen=True):
    buffer: int
    byte_length: int
    byte_offset: int = 0
    byte_stride: int | None = None


class _Buffer(_Struct, frozen=True):
    byte_length: int
    uri: str | None = None


class _Pbr(_Struct, frozen=True):
    base_color_texture: _Present | None = None


class _Material(_Struct, frozen=True):
    pbr_metallic_roughness: _Pbr = _Pbr()


class _Scene(_Struct, frozen=True):
    nodes: list[int] = []


class _Asset(_Struct, frozen=True):
    version: str


class Document(_Struct, frozen=True):
    """The JSON of a glTF file, as far as geometry and levels of detail need it."""

    asset: _Asset
    scene: int | None = None
    scenes: list[_Scene] = []
    nodes: list[Node] = []
    meshes: list[_Mesh] = []
    accessors: list[_Accessor] = []
    buffer_views: list[_View] = []
    buffers: list[_Buffer] = []
    materials: list[_Material] = []

    def roots(self) -> list[int]:
        """Return the root nodes of the default scene, or of the first one."""
        if not self.scenes:
            below = {child for node in self.nodes for child in node.children}
            coarser = {i for node in self.nodes if node.extensions.MSFT_lod for i in _ids(node)}
            return [i for i in range(len(self.nodes)) if i not in below | coarser]
        number = self.scene or 0
        if not 0 <= number < len(self.scenes):
            raise InputError(f"scene: expected 0 to {len(self.scenes) - 1}, got {number}")
        return self.scenes[number].nodes

    def has_texture(self, material: int | None) -> bool:
        """Return whether a material has a colour texture."""
        if material is None:
            return False
        surface = _item(self.materials, material, "materials")
        return surface.pbr_metallic_roughness.base_color_texture is not None

    def walk(self, roots: list[int]) -> Iterator[int]:
        """Yield nodes at and below the roots, parents first; raises InputError on a cycle."""
        seen: set[int] = set()
        stack = roots[::-1]
        while stack:
            number = stack.pop()
            if not 0 <= number < len(self.nodes):
                raise InputError(f"nodes: expected 0 to {len(self.nodes) - 1}, got {number}")
            if number in seen or len(seen) > _MAX_NODES:
                raise InputError(f"nodes: expected a tree, got node {number} reached twice")
            seen.add(number)
            yield number
            stack.extend(reversed(self.nodes[number].children))


def _ids(node: Node) -> list[int]:
    lod = node.extensions.MSFT_lod
    return [] if lod is None else lod.ids


class Gltf:
    """A document with its buffers."""

    def __init__(self, document: Document, binary: bytes, folder: Path | None) -> None:
        self.document, self._binary, self._folder = document, binary, folder
        self._buffers: dict[int, bytes] = {}

    def accessor(self, number: int) -> NDArray[Any]:
        """Return the elements of an accessor, (count, size).

        Raises
        ------
        InputError
            If it is sparse or compressed, or reaches beyond its buffer.
        """
        accessor = _item(self.document.accessors, number, "accessors")
        kind, size = _COMPONENTS.get(accessor.component_type), _SIZES.get(accessor.type)
        if accessor.sparse is not None or accessor.buffer_view is None or not kind or not size:
            raise InputError(
                f"accessor {number}: expected plain numbers in a buffer view, got sparse, "
                "compressed or other ones; export the file without compression"
            )
        view = _item(self.document.buffer_views, accessor.buffer_view, "bufferViews")
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
        buffer = _item(self.document.buffers, number, "buffers")
        if buffer.uri is None:
            return self._binary
        head, _, text = buffer.uri.partition(",")
        if head.startswith("data:"):
            try:
                return base64.b64decode(text, validate=True)
            except binascii.Error as error:
                raise InputError(f"buffer {number}: expected base64, got {error}") from error
        if self._folder is None:
            raise InputError(f"buffer {number}: expected one inside the file, got {buffer.uri!r}")
        path = (self._folder / unquote(buffer.uri)).resolve()
        if not path.is_relative_to(self._folder.resolve()):
            raise InputError(
                f"buffer {number}: expected a file in the folder of the glTF, got {buffer.uri!r}"
            )
        return _read(path)


def _item(items: list[Any], number: int, what: str) -> Any:
    if not 0 <= number < len(items):
        raise InputError(f"{what}: expected 0 to {len(items) - 1}, got {number}")
    return items[number]


def read_gltf(path: Path) -> Gltf:
    """Read a ``.gltf`` or ``.glb`` file.

    Raises
    ------
    InputError
        If it is missing, damaged, too large, or not glTF 2.0.
    """
    data = _read(path)
    try:
        if data[:4] == b"glTF":
            document, binary = parse_glb(data)
            return Gltf(document, binary, path.parent)
        return Gltf(_decode(data), b"", path.parent)
    except InputError as error:
        raise InputError(error.message, path=path) from error


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
    try:
        document = msgspec.json.decode(data, type=Document)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"expected a glTF 2.0 document, got {error}") from error
    if not document.asset.version.startswith("2."):
        raise InputError(f"expected glTF 2.0, got version {document.asset.version!r}")
    return document


def count_meshes(document: Document) -> FloatArray:
    """Return what drawing the whole document takes, in the order of `LEVEL_PREDICTORS`.

    Counts come from the JSON alone, so that compressed geometry counts too; sizes of textures are
    not known from it and stay 0.

    Raises
    ------
    InputError
        If nodes form a cycle, or an index or a count is out of range.
    """
    of_mesh: dict[int, FloatArray] = {}
    total = np.zeros(len(LEVEL_PREDICTORS))
    for number in document.walk(document.roots()):
        mesh = document.nodes[number].mesh
        if mesh is not None:
            if mesh not in of_mesh:
                parts = _item(document.meshes, mesh, "meshes").primitives
                of_mesh[mesh] = sum((_count(document, p) for p in parts), np.zeros(len(total)))
            total += of_mesh[mesh]
    return total


def _count(document: Document, part: Primitive) -> FloatArray:
    vertices = _counted(document, part.attributes.get("POSITION"))
    corners = vertices if part.indices is None else _counted(document, part.indices)
    strip = max(corners - 2, 0)
    triangles = {_TRIANGLES: corners // 3, _STRIP: strip, _FAN: strip}.get(part.mode, 0)
    textured = "TEXCOORD_0" in part.attributes and document.has_texture(part.material)
    skinned = "JOINTS_0" in part.attributes
    values = {
        "draw_calls": 1,
        "vertices": vertices,
        "triangles": triangles,
        "skinned_vertices": vertices if skinned else 0,
        "textured_triangles": triangles if textured else 0,
    }
    return np.array([float(values.get(name, 0)) for name in LEVEL_PREDICTORS])


def _counted(document: Document, accessor: int | None) -> int:
    if accessor is None:
        return 0
    count = _item(document.accessors, accessor, "accessors").count
    if not 0 <= count <= _MAX_COUNT:
        raise InputError(f"accessor {accessor}: expected a count of 0 to 2^31, got {count}")
    return count
