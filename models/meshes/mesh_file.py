"""Meshes from files, in any format that trimesh reads."""

import logging
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.foreign_text import describe_error
from ...base.reader_guard import guarded
from ..gltf.gltf_file import read_gltf
from ..gltf.gltf_textures import TEXEL_BYTES
from .surface_mesh import MeshPart, SurfaceMesh, clean_surface

_MAX_FILE_BYTES = 1 << 30
_ARCHIVES = {"bz2", "tar.bz2", "tar.gz", "zip"}  # what they inflate to is not known beforehand
_PACKED = {".bz2", ".gz", ".zip"}
_TEXTURES = (
    "image",
    "baseColorTexture",
    "metallicRoughnessTexture",
    "normalTexture",
    "occlusionTexture",
    "emissiveTexture",
)
_SILENT = logging.NullHandler()
_GLTF = (".glb", ".gltf")


def load_mesh(path: Path) -> SurfaceMesh:
    """Read a mesh or a scene of meshes as one surface, in the file's own axes and units.

    Nodes are placed by their transforms; polygons become triangles; triangles of one material
    form one part.  Skins, animations, lines and points are left out; so are coarser levels.

    Raises `InputError` if the file is missing, of no known format, damaged, or holds no triangles.
    """
    return load_levels(path)[0]


def load_levels(path: Path) -> list[SurfaceMesh]:
    """Read a mesh as `load_mesh` does with the levels that a glTF file has of it, finest first."""
    with guarded(path, "a mesh", "export it again"):
        if path.suffix.lower() in _GLTF:
            from ..gltf.gltf_surface import load_gltf_levels

            levels = load_gltf_levels(path)
            if levels:
                return levels
        return [_load(path)]


def _load(path: Path) -> SurfaceMesh:
    scene = _parse(path)
    parts: list[MeshPart] = []
    images: dict[int, float] = {}
    materials: dict[int, int] = {}
    kinds: set[str] = set()
    for node in scene.graph.nodes_geometry:
        transform, key = scene.graph[node]
        shape: Any = scene.geometry[key]
        kinds.add(type(shape).__name__)
        if len(getattr(shape, "faces", ())):
            material = materials.setdefault(_material_id(shape), len(materials))
            placing = np.asarray(transform, dtype=np.float64)
            parts.append(_part(shape, placing, material, images))
    if not parts:
        got = ", ".join(sorted(kinds)) or "an empty scene"
        raise InputError(f"expected a mesh with triangles, got {got}", path=path)
    return clean_surface(path.stem, parts, texture_bytes=sum(images.values()))


def _parse(path: Path) -> Any:
    import trimesh

    # What it logs about a file would reach stderr where nobody has set up logging.
    logging.getLogger("trimesh").addHandler(_SILENT)
    if not path.is_file():
        raise InputError("expected a mesh file, got no such file", path=path)
    size = path.stat().st_size
    if not 0 < size <= _MAX_FILE_BYTES:
        raise InputError(f"expected 1 byte to 1 GiB, got {size} bytes", path=path)
    known = sorted(set(trimesh.available_formats()) - _ARCHIVES)
    suffix = path.suffix.lower()
    if suffix.lstrip(".") not in known:
        message = f"expected a mesh format ({', '.join(known)}), got '{path.suffix}'"
        advice = "; unpack it" if suffix in _PACKED else ""
        raise InputError(message + advice, path=path)
    if suffix in {".gltf", ".glb"}:
        read_gltf(path).require_room()
    try:
        return trimesh.load_scene(path, process=False)
    except (MemoryError, RecursionError, ImportError, OSError):
        raise
    except Exception as error:  # each parser of trimesh fails in its own way
        reason = describe_error(error)[:120]
        raise InputError(
            f"expected a readable {path.suffix} mesh, got a damaged one ({reason})", path=path
        ) from error


def _material_id(shape: Any) -> int:
    return id(getattr(shape.visual, "material", None))


def _part(shape: Any, transform: FloatArray, material: int, images: dict[int, float]) -> MeshPart:
    """Return one placed geometry, and note the sizes of its texture images by identity."""
    vertices = np.asarray(shape.vertices, dtype=np.float64)
    faces = np.asarray(shape.faces, dtype=np.int64)
    vertices = vertices @ transform[:3, :3].T + transform[:3, 3]
    if np.linalg.det(transform[:3, :3]) < 0:
        faces = faces[:, ::-1]  # a mirror turns the winding over
    uv = getattr(shape.visual, "uv", None)
    surface = getattr(shape.visual, "material", None)
    candidates = [getattr(surface, name, None) for name in _TEXTURES]
    textures = [image for image in candidates if image is not None]
    for image in textures:
        images[id(image)] = image.width * image.height * TEXEL_BYTES
    return MeshPart(
        vertices,
        faces,
        material=material,
        textured=bool(textures) and uv is not None,
        uv=None if uv is None else np.asarray(uv, dtype=np.float64),
    )
