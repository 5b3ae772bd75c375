"""A whole glTF file as one surface, for those whose textures other readers leave out."""

from pathlib import Path

from ...base.errors import InputError
from ...base.reader_guard import guarded
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from .gltf_file import read_gltf
from .gltf_lod import place_parts
from .gltf_objects import find_objects
from .gltf_schema import pick
from .gltf_textures import Textures
from .named_levels import join_named_levels


def load_ktx2_surface(path: Path) -> SurfaceMesh | None:
    """Read a glTF file with KTX2 textures as one surface, in its own axes; None of other files.

    Nodes with levels are taken at their finest.

    Raises `InputError` as `read_gltf_scene`, and if a texture is not there.
    """
    try:
        gltf = read_gltf(path)
    except InputError:
        return None  # who reads it instead says what is wrong
    document = gltf.document
    if not document.has_ktx2():
        return None
    parts: list[MeshPart] = []
    materials: set[int | None] = set()
    with guarded(path, "a glTF 2.0 file with meshes", "export it again"):
        for thing in find_objects(join_named_levels(document)):
            for placed in thing.levels[0] if thing.levels else ():
                matrix = (thing.transform @ placed.transform)[:3]
                parts += place_parts(gltf, placed, matrix)
                primitives = pick(document.meshes, placed.mesh, "meshes").primitives
                materials.update(primitive.material for primitive in primitives)
        textures = Textures(gltf)
        size = textures.bytes_of(materials)
        if textures.unmeasured:
            names = ", ".join(sorted(textures.unmeasured))
            raise InputError(f"expected its textures beside it, got none readable of {names}")
        if not parts:
            raise InputError("expected a mesh with triangles, got none")
        return clean_surface(path.stem, parts, texture_bytes=size)
