"""The JSON of glTF 2.0, as far as geometry and levels of detail need it."""

from collections.abc import Iterator, Sequence
from typing import TypeVar

import msgspec

from ...base.errors import InputError

TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
"""Modes of a primitive that draw surfaces."""

_MAX_NODES = 1_000_000
_Item = TypeVar("_Item")


class _Struct(msgspec.Struct, frozen=True, rename="camel"):
    """Members that are not named here are skipped."""


class _TextureInfo(_Struct, frozen=True):
    index: int = 0


class _Source(_Struct, frozen=True):
    source: int | None = None


class _TextureExtensions(msgspec.Struct, frozen=True):
    basisu: _Source = msgspec.field(name="KHR_texture_basisu", default=_Source())
    webp: _Source = msgspec.field(name="EXT_texture_webp", default=_Source())


class Texture(_Struct, frozen=True):
    """An image as it is sampled; extensions name one that stands in for it."""

    source: int | None = None
    extensions: _TextureExtensions = _TextureExtensions()

    @property
    def image(self) -> int | None:
        """The image that a renderer shows that knows the extensions."""
        sources = (self.extensions.basisu.source, self.extensions.webp.source, self.source)
        return next((source for source in sources if source is not None), None)


class Image(_Struct, frozen=True):
    """An image, in a file of its own or in a buffer view."""

    uri: str | None = None
    buffer_view: int | None = None
    mime_type: str = ""
    name: str = ""

    @property
    def is_ktx2(self) -> bool:
        """Whether the document says that it is KTX2."""
        return self.mime_type == "image/ktx2" or (self.uri or "").lower().endswith(".ktx2")


class Lod(_Struct, frozen=True):
    """Nodes of coarser levels."""

    ids: list[int]


class NodeExtensions(msgspec.Struct, frozen=True):
    """What extensions say of a node."""

    MSFT_lod: Lod | None = None


class Node(_Struct, frozen=True):
    """A node: its mesh, its children, where it stands, and its coarser levels."""

    mesh: int | None = None
    children: list[int] = []
    matrix: tuple[float, ...] | None = None
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    extensions: NodeExtensions = NodeExtensions()
    name: str = ""

    @property
    def coarser(self) -> list[int]:
        """Nodes of its coarser levels."""
        return [] if self.extensions.MSFT_lod is None else self.extensions.MSFT_lod.ids


class Draco(_Struct, frozen=True):
    """Where the compressed mesh of a primitive is, and Draco's ids of its attributes."""

    buffer_view: int
    attributes: dict[str, int]


class _PrimitiveExtensions(msgspec.Struct, frozen=True):
    draco: Draco | None = msgspec.field(name="KHR_draco_mesh_compression", default=None)


class Primitive(_Struct, frozen=True):
    """Part of a mesh that is drawn by one call."""

    attributes: dict[str, int]
    indices: int | None = None
    material: int | None = None
    mode: int = TRIANGLES
    extensions: _PrimitiveExtensions = _PrimitiveExtensions()


class Mesh(_Struct, frozen=True):
    """Primitives that are drawn together."""

    primitives: list[Primitive]
    name: str = ""


class _SparsePart(_Struct, frozen=True):
    buffer_view: int
    byte_offset: int = 0
    component_type: int = 0


class Sparse(_Struct, frozen=True):
    """Elements that replace some of an accessor's."""

    count: int
    indices: _SparsePart
    values: _SparsePart


class Accessor(_Struct, frozen=True):
    """Numbers in a buffer view."""

    component_type: int
    count: int
    type: str
    buffer_view: int | None = None
    byte_offset: int = 0
    normalized: bool = False
    min: tuple[float, ...] | None = None
    max: tuple[float, ...] | None = None
    sparse: Sparse | None = None


class MeshoptView(_Struct, frozen=True):
    """The compressed form of a buffer view."""

    buffer: int
    byte_length: int
    byte_stride: int
    count: int
    mode: str
    byte_offset: int = 0
    filter: str = "NONE"


class _ViewExtensions(msgspec.Struct, frozen=True):
    meshopt: MeshoptView | None = msgspec.field(name="EXT_meshopt_compression", default=None)


class View(_Struct, frozen=True):
    """A stretch of a buffer."""

    buffer: int
    byte_length: int
    byte_offset: int = 0
    byte_stride: int | None = None
    extensions: _ViewExtensions = _ViewExtensions()


class Buffer(_Struct, frozen=True):
    """Bytes in a file of their own, or, without URI, in the file itself."""

    byte_length: int
    uri: str | None = None


class _Pbr(_Struct, frozen=True):
    base_color_texture: _TextureInfo | None = None
    metallic_roughness_texture: _TextureInfo | None = None


class _Material(_Struct, frozen=True):
    pbr_metallic_roughness: _Pbr = _Pbr()
    normal_texture: _TextureInfo | None = None
    occlusion_texture: _TextureInfo | None = None
    emissive_texture: _TextureInfo | None = None


class _Scene(_Struct, frozen=True):
    nodes: list[int] = []


class Asset(_Struct, frozen=True):
    """What a document says about itself."""

    version: str


class Document(_Struct, frozen=True):
    """The JSON of a glTF file, as far as geometry and levels of detail need it."""

    asset: Asset
    scene: int | None = None
    scenes: list[_Scene] = []
    nodes: list[Node] = []
    meshes: list[Mesh] = []
    accessors: list[Accessor] = []
    buffer_views: list[View] = []
    buffers: list[Buffer] = []
    materials: list[_Material] = []
    textures: list[Texture] = []
    images: list[Image] = []

    def roots(self) -> list[int]:
        """Return the root nodes of the default scene, or of the first one."""
        if not self.scenes:
            below = {child for node in self.nodes for child in node.children}
            coarser = {i for node in self.nodes for i in node.coarser}
            return [i for i in range(len(self.nodes)) if i not in below | coarser]
        return pick(self.scenes, self.scene or 0, "scene").nodes

    def has_texture(self, material: int | None) -> bool:
        """Return whether a material has a colour texture."""
        if material is None:
            return False
        surface = pick(self.materials, material, "materials")
        return surface.pbr_metallic_roughness.base_color_texture is not None

    def images_of(self, material: int | None) -> set[int]:
        """Return the images that a material shows; raises InputError on an index out of range."""
        if material is None:
            return set()
        surface = pick(self.materials, material, "materials")
        pbr = surface.pbr_metallic_roughness
        shown = (
            *(pbr.base_color_texture, pbr.metallic_roughness_texture, surface.normal_texture),
            *(surface.occlusion_texture, surface.emissive_texture),
        )
        found = {pick(self.textures, info.index, "textures").image for info in shown if info}
        return {image for image in found if image is not None}

    def has_ktx2(self) -> bool:
        """Return whether the document says that an image is KTX2."""
        named = any(texture.extensions.basisu.source is not None for texture in self.textures)
        return named or any(image.is_ktx2 for image in self.images)

    def image_name(self, number: int) -> str:
        """Return what an image is called: its file, its name, or its number."""
        image = pick(self.images, number, "images")
        file = image.uri if image.uri and not image.uri.startswith("data:") else ""
        return (file or image.name or f"image {number}")[-80:]

    def walk(self, roots: list[int]) -> Iterator[int]:
        """Yield nodes at and below the roots, parents first; raises InputError on a cycle."""
        seen: set[int] = set()
        stack = roots[::-1]
        while stack:
            number = stack.pop()
            node = pick(self.nodes, number, "nodes")
            if number in seen or len(seen) > _MAX_NODES:
                raise InputError(f"nodes: expected a tree, got node {number} reached twice")
            seen.add(number)
            yield number
            stack.extend(reversed(node.children))


def pick(items: Sequence[_Item], number: int, what: str) -> _Item:
    """Return an item by its index; raises InputError if there is none."""
    if not 0 <= number < len(items):
        raise InputError(f"{what}: expected 0 to {len(items) - 1}, got {number}")
    return items[number]
