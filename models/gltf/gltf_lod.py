"""glTF 2.0 files as flat scenes whose objects have the levels that ``MSFT_lod`` gives them.

An object is a node with a mesh, or a node with ``MSFT_lod`` and all below it.  Objects of equal
meshes, turned and scaled alike, share a type.  Levels of materials, skins, morphs and animations
are not read.  Microsoft, "MSFT_lod", vendor extension of glTF 2.0.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.errors import InputError, about_file
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..meshes.type_model import TypeModel, gather_types, measure_levels
from ..scene.rotation import rotation_matrix
from ..scene.scene import Scene
from ..scene.scene_file import SceneOrigin
from .gltf_file import Gltf, read_gltf
from .gltf_schema import TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES, Document, Node, Primitive, pick

_Y_UP = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))  # glTF's axes as ours
_MAX_LEVELS = 32
_MAX_OBJECTS = 100_000
_Key: TypeAlias = tuple[tuple[tuple[tuple[int, bytes], ...], ...], bytes]


@dataclass(frozen=True, slots=True)
class _Placed:
    """A mesh with its transform (4, 4) relative to some node."""

    mesh: int
    transform: FloatArray


@dataclass(frozen=True, slots=True)
class _Object:
    """Meshes of each level, finest first, in the frame of the object, and where it stands."""

    name: str
    levels: tuple[tuple[_Placed, ...], ...]
    transform: FloatArray

    @property
    def key(self) -> _Key:
        """What objects of one type have in common."""
        meshes = tuple(
            tuple((placed.mesh, placed.transform.round(9).tobytes()) for placed in level)
            for level in self.levels
        )
        return meshes, self.transform[:3, :3].round(9).tobytes()


def read_gltf_scene(
    path: Path, sampling: Sampling | None = None
) -> tuple[Scene, Geometry, SceneOrigin]:
    """Read a ``.gltf`` or ``.glb`` with its levels; their errors are measured.

    Raises `InputError` if the file is missing, damaged, compressed, no glTF 2.0, or holds no
    triangles; or if the levels of a node are not ever coarser.
    """
    gltf = read_gltf(path)
    with about_file(path), np.errstate(over="ignore", invalid="ignore"):
        return _read(gltf, path, sampling or Sampling())


def _read(gltf: Gltf, path: Path, sampling: Sampling) -> tuple[Scene, Geometry, SceneOrigin]:
    objects = list(_objects(gltf.document))
    kinds: dict[_Key, int] = {}
    models: list[TypeModel] = []
    type_index: list[int] = []
    for thing in objects:
        if thing.key not in kinds:
            kinds[thing.key] = len(models)
            models.append(_model(gltf, thing, sampling))
        type_index.append(kinds[thing.key])
    if not objects:
        raise InputError("expected a node with a mesh, got none")
    types, geometry = gather_types(models)
    position = np.stack([_Y_UP @ thing.transform[:3, 3] for thing in objects])
    scene = Scene.of(path.stem, types, np.array(type_index), position)
    chains = sum(len(thing.levels) > 1 for thing in objects)
    return scene, geometry, SceneOrigin("gltf", (path.name,), {"objects_with_levels": chains})


def _objects(document: Document) -> Iterator[_Object]:
    """Yield the objects of the default scene."""
    count = 0
    for number, transform in _walk(document, document.roots(), np.eye(4), stop_at_levels=True):
        node = document.nodes[number]
        lod = node.extensions.MSFT_lod
        if lod is None and node.mesh is None:
            continue
        ids = node.coarser
        count += 1
        if len(ids) >= _MAX_LEVELS or count > _MAX_OBJECTS:
            raise InputError(
                f"expected at most {_MAX_OBJECTS} objects of {_MAX_LEVELS} levels, got more"
            )
        name = node.name or _mesh_name(document, node) or f"node-{number}"
        if lod is None:
            assert node.mesh is not None
            yield _Object(name, ((_Placed(node.mesh, np.eye(4)),),), transform)
            continue
        # A level stands where the finest one does: both give their own place in the parent.
        inverse = _inverse(_local(node), number)
        levels = [_meshes_below(document, number, inverse)]
        levels += [_meshes_below(document, i, inverse) for i in ids]
        # An empty last level means that the object is not drawn from far away.
        yield _Object(name, tuple(level for level in levels if level), transform)


def _mesh_name(document: Document, node: Node) -> str:
    return "" if node.mesh is None else pick(document.meshes, node.mesh, "meshes").name


def _meshes_below(document: Document, number: int, inverse: FloatArray) -> tuple[_Placed, ...]:
    walk = _walk(document, [number], inverse, stop_at_levels=False)
    meshes = ((document.nodes[below].mesh, transform) for below, transform in walk)
    return tuple(_Placed(mesh, transform) for mesh, transform in meshes if mesh is not None)


def _walk(
    document: Document, roots: list[int], above: FloatArray, *, stop_at_levels: bool
) -> Iterator[tuple[int, FloatArray]]:
    """Yield nodes and their transforms, parents first; not below nodes with levels if told so."""
    parents = dict.fromkeys(roots, above)
    for number in document.walk(roots):
        if number not in parents:  # below a node with levels
            continue
        node = document.nodes[number]
        transform = parents[number] @ _local(node)
        if not np.isfinite(transform).all():
            raise InputError(f"node {number}: expected a finite transform, got another")
        yield number, transform
        if not stop_at_levels or node.extensions.MSFT_lod is None:
            parents |= dict.fromkeys(node.children, transform)


def _local(node: Node) -> FloatArray:
    """Return the (4, 4) transform of a node in its parent."""
    if node.matrix is not None:
        if len(node.matrix) != 16:
            raise InputError(f"matrix: expected 16 numbers, got {len(node.matrix)}")
        return np.array(node.matrix).reshape(4, 4).T
    unit = np.array(node.rotation) / max(float(np.linalg.norm(node.rotation)), 1e-300)
    result = np.eye(4)
    result[:3, :3] = rotation_matrix(unit) * node.scale
    result[:3, 3] = node.translation
    return result


def _inverse(matrix: FloatArray, number: int) -> FloatArray:
    try:
        inverse: FloatArray = np.linalg.inv(matrix).astype(np.float64)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"node {number}: expected a transform with an inverse, got none"
        ) from error
    return inverse


def _model(gltf: Gltf, thing: _Object, sampling: Sampling) -> TypeModel:
    """Return a type whose frame has the turn and the scale of the object."""
    linear = _Y_UP @ thing.transform[:3, :3]
    surfaces = [_surface(gltf, thing.name, level, linear) for level in thing.levels]
    if not surfaces:
        raise InputError(f"{thing.name}: expected a mesh in its levels, got none")
    return measure_levels(surfaces, sampling)


def _surface(gltf: Gltf, name: str, level: Sequence[_Placed], linear: FloatArray) -> SurfaceMesh:
    parts = [
        part for placed in level for part in _parts(gltf, placed, linear @ placed.transform[:3])
    ]
    return clean_surface(name, parts)


def _parts(gltf: Gltf, placed: _Placed, matrix: FloatArray) -> Iterator[MeshPart]:
    """Yield the triangles of a mesh, placed by a (3, 4) matrix."""
    document = gltf.document
    for primitive in pick(document.meshes, placed.mesh, "meshes").primitives:
        if "POSITION" not in primitive.attributes:
            continue
        points = gltf.accessor(primitive.attributes["POSITION"]).astype(np.float64)
        corners = np.arange(len(points))
        if primitive.indices is not None:
            corners = gltf.accessor(primitive.indices)[:, 0].astype(np.int64)
        faces = _triangles(corners, primitive.mode)
        if points.shape[1] != 3 or len(faces) == 0:
            continue
        if np.linalg.det(matrix[:, :3]) < 0.0:
            faces = faces[:, ::-1]  # a mirror turns the winding over
        material = -1 if primitive.material is None else primitive.material
        uv = _uv(gltf, primitive, len(points))
        textured = uv is not None and document.has_texture(primitive.material)
        placed_points = points @ matrix[:, :3].T + matrix[:, 3]
        yield MeshPart(placed_points, faces, material, textured, uv)


def _uv(gltf: Gltf, primitive: Primitive, count: int) -> FloatArray | None:
    """Return texture coordinates; integers, which stand for [0, 1], are scaled to it."""
    number = primitive.attributes.get("TEXCOORD_0")
    if number is None:
        return None
    uv = gltf.accessor(number)
    if uv.shape != (count, 2):
        raise InputError(f"accessor {number}: expected ({count}, 2) numbers, got {uv.shape}")
    whole = 1.0 if uv.dtype.kind == "f" else float(np.iinfo(uv.dtype).max)
    return uv.astype(np.float64) / whole


def _triangles(corners: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Return (f, 3) faces of a list, a strip or a fan; nothing of lines and points."""
    if mode == TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if mode not in (TRIANGLE_STRIP, TRIANGLE_FAN) or len(corners) < 3:
        return np.empty((0, 3), dtype=np.int64)
    second = np.arange(1, len(corners) - 1)
    first = np.zeros_like(second) if mode == TRIANGLE_FAN else second - 1
    order = np.stack((first, second, second + 1), axis=1)
    if mode == TRIANGLE_STRIP:
        order[1::2] = order[1::2][:, [1, 0, 2]]
    return corners[order]
