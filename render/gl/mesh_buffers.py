"""The meshes of all levels in vertex and index buffers, and the parts that are drawn of each."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ...models.meshes.geometry import Geometry, LevelMesh
from ...models.scene.scene import Scene
from .shaders import BONES
from .vertex_order import cache_friendly

if TYPE_CHECKING:
    import moderngl

_SKINNED = LEVEL_PREDICTORS.index("skinned_vertices")
_TEXTURED = LEVEL_PREDICTORS.index("textured_triangles")
_VERTEX = np.dtype([("position", "3f4"), ("normal", "3f4"), ("uv", "2f4")])
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


@dataclass(frozen=True, slots=True)
class Meshes:
    """Buffers and what is in them, by row of the level table.

    Attributes
    ----------
    vertex, skin, index : moderngl.Buffer
    parts : parts of each row
    vertices : vertices of each row
    skinned : whether each row is
    """

    vertex: "moderngl.Buffer"
    skin: "moderngl.Buffer"
    index: "moderngl.Buffer"
    parts: tuple[tuple[Part, ...], ...]
    vertices: tuple[int, ...]
    skinned: tuple[bool, ...]


def upload(context: "moderngl.Context", scene: Scene, geometry: Geometry) -> Meshes:
    """Upload a scene's meshes.

    Raises `InputError` if there are none, or not one for each level, or they do not fit the device.
    """
    levels = scene.types.levels
    rows = len(levels.error_m)
    if len(geometry) != rows:
        raise InputError(
            f"{scene.name}: expected {rows} meshes to draw, one for each level, got "
            f"{len(geometry)}; record a scene that `lodbench scene build` makes, or glTF"
        )
    geometry = tuple(map(cache_friendly, geometry))
    skinned = tuple(bool(count > 0.0) for count in levels.counts[:, _SKINNED])
    start = np.concatenate(([0], np.cumsum([len(mesh.vertices) for mesh in geometry])))
    vertex, skin = np.zeros(start[-1], _VERTEX), np.zeros(start[-1], _SKIN)
    parts: list[tuple[Part, ...]] = []
    indices: list[Any] = []
    drawn = 0
    for row, mesh in enumerate(geometry):
        block = slice(start[row], start[row + 1])
        vertex["position"][block], vertex["normal"][block] = mesh.vertices, mesh.normals
        if mesh.uv is not None:
            vertex["uv"][block] = mesh.uv
        if skinned[row]:
            skin[block] = _weights(mesh)
        indices.append(mesh.faces.ravel().astype(np.uint32) + np.uint32(start[row]))
        parts.append(_parts(mesh, drawn, float(levels.counts[row, _TEXTURED])))
        drawn += 3 * len(mesh.faces)
    data = np.concatenate(indices)
    try:
        vertex_buffer, skin_buffer, index_buffer = (
            context.buffer(array.tobytes()) for array in (vertex, skin, data)
        )
    except Exception as error:  # moderngl raises plain Exception
        size = vertex.nbytes + skin.nbytes + data.nbytes
        message = f"expected a device with room for {size / 1e6:.0f} MB of meshes, got: {error}"
        raise InputError(f"{scene.name}: {message}; record a smaller scene") from error
    return Meshes(
        vertex_buffer,
        skin_buffer,
        index_buffer,
        tuple(parts),
        tuple(len(mesh.vertices) for mesh in geometry),
        skinned,
    )


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
