"""The meshes of levels in vertex and index buffers, and the parts that are drawn of each."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ...models.meshes.geometry import INDEX_BYTES, Geometry, LevelMesh
from ...models.scene.scene import Scene
from .shaders import BONES
from .vertex_order import cache_friendly

if TYPE_CHECKING:
    import moderngl

_SKINNED = LEVEL_PREDICTORS.index("skinned_vertices")
_TEXTURED = LEVEL_PREDICTORS.index("textured_triangles")
_VERTEX = np.dtype([("position", "3f4"), ("normal", "3f4"), ("uv", "2f4")])
_LEAST = 1 << 16  # vertices, and triangles
_SKIN = np.dtype([("bones", "4u1"), ("weights", "4u1")])


@dataclass(frozen=True, slots=True)
class Part:
    """Triangles of one level that one call draws.

    Attributes
    ----------
    first, indices : range in the index buffer
    textured : whether the texture is sampled
    """

    first: int
    indices: int
    textured: bool


class Meshes:
    """The meshes of a scene's levels, each on the device since it was first asked for.

    All lie in the same three buffers, so that none is bound anew from level to level; when they
    are full, larger ones take their place.

    Raises `InputError` if there are none, or not one for each level.

    Attributes
    ----------
    vertex, skin, index : moderngl.Buffer
    parts : dict of int to tuple of Part
        Parts of each row of the level table that is loaded.
    vertices : dict of int to int
        Vertices of each.
    skinned : whether each row is, loaded or not
    """

    def __init__(self, context: "moderngl.Context", scene: Scene, geometry: Geometry) -> None:
        levels = scene.types.levels
        rows = len(levels.error_m)
        if len(geometry) != rows:
            raise InputError(
                f"{scene.name}: expected {rows} meshes to draw, one for each level, got "
                f"{len(geometry)}; record a scene that `lodbench scene build` makes, or glTF"
            )
        self._context, self._scene, self._geometry = context, scene, geometry
        self._textured: list[float] = levels.counts[:, _TEXTURED].tolist()
        self.skinned = tuple(bool(count > 0.0) for count in levels.counts[:, _SKINNED])
        self.parts: dict[int, tuple[Part, ...]] = {}
        self.vertices: dict[int, int] = {}
        self._used = [0, 0]  # vertices and indices
        self.vertex, self.skin, self.index = self._reserve(_LEAST, 3 * _LEAST)

    def load(self, rows: Iterable[int]) -> bool:
        """Upload what is not there yet; return whether other buffers took the place of these.

        Raises `InputError` if the device has no room.
        """
        new = [row for row in dict.fromkeys(rows) if row not in self.parts]
        meshes = [cache_friendly(self._geometry[row]) for row in new]
        need = [sum(len(mesh.vertices) for mesh in meshes), sum(mesh.faces.size for mesh in meshes)]
        grown = self._make_room(*need)
        for row, mesh in zip(new, meshes, strict=True):
            self._upload(row, mesh)
        if new:
            self._context.finish()  # the frame that is drawn next does not pay for it
        return grown

    def load_all(self) -> bool:
        """Upload the meshes of all levels, as `load` does."""
        return self.load(range(len(self._geometry)))

    def _upload(self, row: int, mesh: LevelMesh) -> None:
        begin, first = self._used
        vertex = np.zeros(len(mesh.vertices), _VERTEX)
        vertex["position"], vertex["normal"] = mesh.vertices, mesh.normals
        if mesh.uv is not None:
            vertex["uv"] = mesh.uv
        self.vertex.write(vertex.tobytes(), offset=begin * _VERTEX.itemsize)
        if self.skinned[row]:
            self.skin.write(_weights(mesh).tobytes(), offset=begin * _SKIN.itemsize)
        indices = mesh.faces.ravel().astype(np.uint32) + np.uint32(begin)
        self.index.write(indices.tobytes(), offset=first * INDEX_BYTES)
        self.parts[row] = _parts(mesh, first, self._textured[row])
        self.vertices[row] = len(mesh.vertices)
        self._used = [begin + len(mesh.vertices), first + mesh.faces.size]

    def _make_room(self, vertices: int, indices: int) -> bool:
        """Return whether there had to be other buffers, of twice the size at least."""
        need = (self._used[0] + vertices, self._used[1] + indices)
        have = (self.vertex.size // _VERTEX.itemsize, self.index.size // INDEX_BYTES)
        if need[0] <= have[0] and need[1] <= have[1]:
            return False
        sizes = (
            max(least, 2 * size) if least > size else size
            for least, size in zip(need, have, strict=True)
        )
        before = (self.vertex, self.skin, self.index)
        self.vertex, self.skin, self.index = self._reserve(*sizes)
        for old, new in zip(before, (self.vertex, self.skin, self.index), strict=True):
            self._context.copy_buffer(new, old, size=old.size)
            old.release()
        return True

    def _reserve(self, vertices: int, indices: int) -> "list[moderngl.Buffer]":
        sizes = (vertices * _VERTEX.itemsize, vertices * _SKIN.itemsize, indices * INDEX_BYTES)
        try:
            return [self._context.buffer(reserve=size) for size in sizes]
        except Exception as error:  # moderngl raises plain Exception
            wanted = f"expected a device with room for {sum(sizes) / 1e6:.0f} MB of meshes"
            message = f"{wanted}, got: {error}; record a smaller scene"
            raise InputError(f"{self._scene.name}: {message}") from error


def _parts(mesh: LevelMesh, first: int, textured_triangles: float) -> tuple[Part, ...]:
    """Return the parts of a mesh; those are textured whose triangles the level table counts so."""
    left = textured_triangles if mesh.uv is not None else 0.0
    parts: list[Part] = []
    for begin, end in zip(mesh.part_start[:-1].tolist(), mesh.part_start[1:].tolist(), strict=True):
        size = end - begin
        textured = 0 < size <= left
        left -= size if textured else 0
        if size:
            parts.append(Part(first + 3 * begin, 3 * size, textured))
    return tuple(parts)


def _weights(mesh: LevelMesh) -> Any:
    """Return four bones and weights of each vertex, by height: scenes store no skeletons.

    Bones stand evenly from the lowest to the highest vertex; a vertex follows those nearest to it.
    """
    z = mesh.vertices[:, 2].astype(np.float64)
    low, high = z.min(), z.max()
    at = (z - low) / max(high - low, 1e-9) * (BONES - 1)
    base = np.clip(np.floor(at).astype(np.int64) - 1, 0, BONES - 4)
    bones = base[:, None] + np.arange(4)
    near = np.maximum(0.0, 2.0 - np.abs(bones - at[:, None]))
    share = np.floor(255.0 * near / near.sum(axis=1, keepdims=True)).astype(np.int64)
    share[:, 0] += 255 - share.sum(axis=1)  # bytes that add up to one
    skin = np.zeros(len(z), _SKIN)
    skin["bones"], skin["weights"] = bones, share
    return skin
