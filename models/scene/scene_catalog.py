"""Scenes by name or by file: the bundled ones, scene files, 3D Tiles tilesets, glTF and USD."""

from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from ...base.errors import InputError, is_file, text_of
from ...base.nearest_names import unknown_name
from ..meshes.geometry import Geometry
from ..scenes.scene_cache import SUFFIX, cached_scene
from ..scenes.scene_registry import SCENES, find_builder
from .scene import Scene
from .scene_file import SceneOrigin, read_geometry, read_origin, read_scene

_MESHES = (".obj", ".ply", ".stl", ".off", ".dae", ".3mf")
"""Suffixes of files that hold meshes and no scene."""

_USD = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True, slots=True)
class OpenedScene:
    """A scene, where it comes from, and how to get the meshes of its levels.

    Attributes
    ----------
    read_geometry : callable
        Returns one mesh for each row of the level table, or none where the source has none.
    """

    scene: Scene
    origin: SceneOrigin
    read_geometry: Callable[[], Geometry]


def list_bundled_scenes() -> tuple[str, ...]:
    """Return the names of the bundled scenes, sorted."""
    return tuple(sorted(SCENES))


def load_scene(name_or_path: str | PathLike[str] | Scene) -> Scene:
    """Return the bundled scene of that name, or that of a file, as `open_scene` does.

    A scene is returned as it is.

    Raises `InputError` as `open_scene` does.
    """
    if isinstance(name_or_path, Scene):
        return name_or_path
    return open_scene(text_of(name_or_path, "scene", Scene)).scene


def open_scene(spec: str) -> OpenedScene:
    """Open the bundled scene of that name, or the file of that path.

    Bundled scenes are made the first time and kept in `scene_cache.cache_folder`.
    ``.json`` is a 3D Tiles tileset, ``.gltf`` and ``.glb`` are glTF 2.0, ``.usd`` and its kin USD,
    anything else is a scene file.

    Raises `InputError` if there is neither, with the nearest bundled name, or if the file is not a
    scene.
    """
    build = find_builder(spec)
    if build is not None:
        scene, geometry = cached_scene(spec, build)
        return OpenedScene(scene, SceneOrigin("bundled"), geometry)
    path = Path(spec)
    suffix = path.suffix.lower()
    if suffix == ".json":
        from ..tiles.tileset import read_tileset

        return OpenedScene(*read_tileset(path), tuple)
    if suffix in (".gltf", ".glb"):
        from ..gltf.gltf_lod import read_gltf_scene

        scene, meshes, origin = read_gltf_scene(path)
        return OpenedScene(scene, origin, lambda: meshes)
    if suffix in _USD:
        from ..usd.usd_scene import read_usd_scene

        scene, meshes, origin = read_usd_scene(path)
        return OpenedScene(scene, origin, lambda: meshes)
    if suffix in _MESHES and is_file(path):
        message = (
            f"expected a scene, got a mesh; lodbench scene build {path.name} --out NAME{SUFFIX}"
        )
        raise InputError(message, path=path)
    if suffix == SUFFIX or is_file(path):
        return OpenedScene(read_scene(path), read_origin(path), lambda: read_geometry(path))
    names = list_bundled_scenes()
    files = f"a file ({SUFFIX}, tileset.json, .gltf, .glb, .usd)"
    raise InputError(f"scene: {unknown_name(spec, names, instead=files)}")
