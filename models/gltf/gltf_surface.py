"""Whole glTF files as surfaces, for those of which other readers leave something out.

trimesh leaves out KTX2 textures, and draws the levels of a node on top of each other.
"""

from collections.abc import Sequence
from pathlib import Path

from ...base.errors import InputError
from ...base.reader_guard import guarded
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from .gltf_accessors import Gltf
from .gltf_file import read_gltf
from .gltf_lod import place_parts
from .gltf_objects import Thing, find_objects
from .gltf_schema import pick
from .gltf_textures import Textures
from .named_levels import join_named_levels


def load_gltf_levels(path: Path) -> list[SurfaceMesh]:
    """Read a glTF file with KTX2 textures or levels as a surface a level, in its own axes.

    Level k shows each object at its own level k, or at its coarsest where it has fewer.  The list
    is empty of other files.

    Raises `InputError` as `read_gltf_scene`, and if a KTX2 texture is not there.
    """
    try:
        gltf = read_gltf(path)
    except InputError:
        return []  # who reads it instead says what is wrong
    with guarded(path, "a glTF 2.0 file with meshes", "export it again"):
        gltf.document = join_named_levels(gltf.document)
        ktx2, has_levels = gltf.document.has_ktx2(), any(n.coarser for n in gltf.document.nodes)
        if not (ktx2 or has_levels):
            return []
        objects = [thing for thing in find_objects(gltf.document) if thing.levels]
        textures = Textures(gltf)
        count = max((len(thing.levels) for thing in objects), default=0)
        levels = [_surface(gltf, textures, path.stem, objects, level) for level in range(count)]
        if ktx2 and textures.unmeasured:
            names = ", ".join(sorted(textures.unmeasured))
            raise InputError(f"expected its textures beside it, got none readable of {names}")
        if not levels:
            raise InputError("expected a mesh with triangles, got none")
        return levels


def _surface(
    gltf: Gltf, textures: Textures, name: str, objects: Sequence[Thing], level: int
) -> SurfaceMesh:
    parts: list[MeshPart] = []
    materials: set[int | None] = set()
    for thing in objects:
        for placed in thing.levels[min(level, len(thing.levels) - 1)]:
            parts += place_parts(gltf, placed, (thing.transform @ placed.transform)[:3])
            primitives = pick(gltf.document.meshes, placed.mesh, "meshes").primitives
            materials.update(primitive.material for primitive in primitives)
    size = textures.bytes_of(materials)
    if not parts:
        raise InputError("expected a mesh with triangles, got none")
    return clean_surface(name, parts, texture_bytes=size)
