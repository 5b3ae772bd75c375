"""The JSON of 3D Tiles 1.0 and 1.1, as far as a scene needs it.

Open Geospatial Consortium, "3D Tiles specification", 22-025r4.  Numbers come in tuples of fixed
length, so that a hostile file cannot make a small text large.
"""

from typing import Literal, TypeAlias

import msgspec

from ..gltf.gltf_schema import Asset, Buffer

_Six: TypeAlias = tuple[float, float, float, float, float, float]
_Twelve: TypeAlias = tuple[
    float, float, float, float, float, float, float, float, float, float, float, float
]
_Sixteen: TypeAlias = tuple[
    float, float, float, float, float, float, float, float,
    float, float, float, float, float, float, float, float,
]  # fmt: skip


class _Struct(msgspec.Struct, frozen=True, rename="camel"):
    """Members that are not named here are skipped."""


class Volume(_Struct, frozen=True):
    """A bounding volume: one of a box, a sphere and a region."""

    box: _Twelve | None = None
    sphere: tuple[float, float, float, float] | None = None
    region: _Six | None = None


class Content(_Struct, frozen=True):
    """What a tile draws; ``url`` is how version 0.0 called the URI."""

    uri: str | None = None
    url: str | None = None

    @property
    def link(self) -> str:
        """The URI under either name."""
        return self.uri or self.url or ""


class _Template(_Struct, frozen=True):
    uri: str


class ImplicitTiling(_Struct, frozen=True):
    """A tree that is told by its rule of subdivision and by bits of what is there."""

    subdivision_scheme: Literal["QUADTREE", "OCTREE"]
    subtree_levels: int
    subtrees: _Template
    available_levels: int | None = None
    maximum_level: int | None = None  # the name in the extension to 3D Tiles 1.0

    @property
    def levels(self) -> int:
        """Levels of the whole tree."""
        if self.available_levels is not None:
            return self.available_levels
        return 0 if self.maximum_level is None else self.maximum_level + 1


class _TileExtensions(msgspec.Struct, frozen=True):
    implicit: ImplicitTiling | None = msgspec.field(name="3DTILES_implicit_tiling", default=None)


class Tile(_Struct, frozen=True):
    """A tile of an explicit tree, or the root of an implicit one."""

    bounding_volume: Volume
    geometric_error: float | None = None
    refine: str | None = None
    transform: _Sixteen | None = None
    content: Content | None = None
    contents: list[Content] = []
    children: list["Tile"] = []
    implicit_tiling: ImplicitTiling | None = None
    viewer_request_volume: Volume | None = None
    extensions: _TileExtensions = _TileExtensions()

    @property
    def links(self) -> tuple[str, ...]:
        """URIs of all contents."""
        single = () if self.content is None else (self.content,)
        return tuple(content.link for content in (*single, *self.contents) if content.link)

    @property
    def implicit(self) -> ImplicitTiling | None:
        """The implicit tree that begins here, if one does."""
        return self.implicit_tiling or self.extensions.implicit


class Tileset(_Struct, frozen=True):
    """A tileset document."""

    asset: Asset
    root: Tile


class Availability(_Struct, frozen=True):
    """Flags: all alike, or bits in a buffer view."""

    constant: int | None = None
    bitstream: int | None = None
    buffer_view: int | None = None  # the name in the extension to 3D Tiles 1.0

    @property
    def bits(self) -> int | None:
        """The buffer view that holds the bits, if one does."""
        return self.buffer_view if self.bitstream is None else self.bitstream


class _BufferView(_Struct, frozen=True):
    buffer: int
    byte_offset: int
    byte_length: int


class Subtree(_Struct, frozen=True):
    """What is there of one subtree of an implicit tree."""

    tile_availability: Availability
    child_subtree_availability: Availability
    content_availability: list[Availability] | Availability = []
    buffers: list[Buffer] = []
    buffer_views: list[_BufferView] = []
