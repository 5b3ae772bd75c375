"""glTF 2.0 files as flat scenes whose objects have the levels that ``MSFT_lod`` gives them.

An object is a node with a mesh, or a node with ``MSFT_lod`` and all below it; siblings named as
levels are one too.  Objects of equal meshes, turned and scaled alike, share a type.  Levels of
materials, skins, morphs and animations are not read.  Microsoft, "MSFT_lod", vendor extension of
glTF 2.0.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.reader_guard import guarded
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..meshes.type_model import TypeModel, gather_types, measure_levels
from ..scene.scene import Scene
from ..scene.scene_file import SceneOrigin
from .gltf_accessors import Gltf, MissingBufferError
from .gltf_counted import counted_types
from .gltf_file import read_gltf
from .gltf_objects import Key, Placed, Thing, find_objects
from .gltf_schema import TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES, pick
from .gltf_textures import Textures
from .named_levels import join_named_levels

_Y_UP = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))  # glTF's axes as ours


def read_gltf_scene(
    path: Path, sampling: Sampling | None = None
) -> tuple[Scene, Geometry, SceneOrigin]:
    """Read a ``.gltf`` or ``.glb`` with its levels; their errors are measured.

    Where a buffer is not there, objects of one level have their counts and boxes, and no mesh.

    Raises `InputError` if the file is missing, damaged, no glTF 2.0, or holds no triangles; if it
    is compressed and there is no decoder; or if the levels of a node are not ever coarser.
    """
    gltf = read_gltf(path)
    with guarded(path, "a glTF 2.0 file with meshes", "export it again"):
        gltf.document = join_named_levels(gltf.document)
        return _read(gltf, path, sampling or Sampling())


def _read(gltf: Gltf, path: Path, sampling: Sampling) -> tuple[Scene, Geometry, SceneOrigin]:
    objects = list(find_objects(gltf.document))
    if not objects:
        raise InputError("expected a node with a mesh, got none")
    kinds: dict[Key, int] = {}
    first: list[Thing] = []
    for thing in objects:
        if thing.key not in kinds:
            kinds[thing.key] = len(first)
            first.append(thing)
    about: dict[str, str | float | bool | None] = {
        "objects_with_levels": sum(len(thing.levels) > 1 for thing in objects)
    }
    geometry: Geometry = ()
    textures = Textures(gltf)
    try:
        models = [_model(gltf, textures, thing, sampling) for thing in first]
        types, geometry = gather_types(models)
    except MissingBufferError as missing:
        types = counted_types(gltf.document, first, _Y_UP)
        about["buffer_missing"] = f"{Path(missing.path or '').name}, so boxes in place of meshes"
    if textures.unmeasured:
        about["textures_not_counted"] = ", ".join(sorted(textures.unmeasured))[:200]
    type_index = np.array([kinds[thing.key] for thing in objects])
    position = np.stack([_Y_UP @ thing.transform[:3, 3] for thing in objects])
    scene = Scene.of(path.stem, types, type_index, position)
    return scene, geometry, SceneOrigin("gltf", (path.name,), about)


def _model(gltf: Gltf, textures: Textures, thing: Thing, sampling: Sampling) -> TypeModel:
    """Return a type whose frame has the turn and the scale of the object."""
    linear = _Y_UP @ thing.transform[:3, :3]
    surfaces = [_surface(gltf, textures, thing.name, level, linear) for level in thing.levels]
    if not surfaces:
        raise InputError(f"{thing.name}: expected a mesh in its levels, got none")
    return measure_levels(surfaces, sampling)


def _surface(
    gltf: Gltf, textures: Textures, name: str, level: Sequence[Placed], linear: FloatArray
) -> SurfaceMesh:
    parts: list[MeshPart] = []
    materials: set[int | None] = set()
    for placed in level:
        parts += place_parts(gltf, placed, linear @ placed.transform[:3])
        primitives = pick(gltf.document.meshes, placed.mesh, "meshes").primitives
        materials.update(primitive.material for primitive in primitives)
    return clean_surface(name, parts, texture_bytes=textures.bytes_of(materials))


def place_parts(gltf: Gltf, placed: Placed, matrix: FloatArray) -> Iterator[MeshPart]:
    """Yield the triangles of a mesh, placed by a (3, 4) matrix; raises as `Gltf.points`."""
    document = gltf.document
    for primitive in pick(document.meshes, placed.mesh, "meshes").primitives:
        if "POSITION" not in primitive.attributes:
            continue
        points, corners, uv = gltf.points(primitive)
        faces = _triangles(corners, primitive.mode)
        if len(faces) == 0:
            continue
        if np.linalg.det(matrix[:, :3]) < 0.0:
            faces = faces[:, ::-1]  # a mirror turns the winding over
        material = -1 if primitive.material is None else primitive.material
        textured = uv is not None and document.has_texture(primitive.material)
        placed_points = points @ matrix[:, :3].T + matrix[:, 3]
        yield MeshPart(placed_points, faces, material, textured, uv)


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
