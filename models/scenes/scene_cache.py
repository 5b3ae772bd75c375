"""Generated scenes on disk, so that each is made once.

A file is named after its scene and a digest of what it is made by: the sources of the package's
floors `base` and `models`, and the versions of the libraries that make meshes.  So it is never
stale, and files of older digests are removed.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path

from ...base.errors import InputError
from ..meshes.geometry import Geometry
from ..scene.scene import Scene
from ..scene.scene_file import SceneOrigin, read_geometry, read_scene, write_scene
from .scene_registry import Build

SUFFIX = ".lodscene"
_VARIABLE = "LODBENCH_CACHE"
_LIBRARIES = ("fast-simplification", "numpy", "scipy", "trimesh")
_UNREADABLE = (InputError, OSError)


def cache_folder() -> Path:
    """Return where generated scenes are kept: ``LODBENCH_CACHE``, or the platform's cache.

    Raises `RuntimeError` where the user has no home.
    """
    named = os.environ.get(_VARIABLE)
    if named:
        return Path(named)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "lodbench"
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
        return Path(local) / "lodbench" / "Cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "lodbench"


def cached_scene(name: str, build: Build) -> tuple[Scene, Callable[[], Geometry]]:
    """Return a generated scene, and what reads its geometry.

    What is missing from the cache, or damaged there, is made anew.  Where there is no cache, or it
    cannot be written to, the scene is made in memory, which a line on stderr says once.
    """
    try:
        path = cache_folder() / f"{name}.{_digest()}{SUFFIX}"
    except RuntimeError:  # an account of a job or a container may have no home
        _say_once("there is no home folder for them; name a")
        scene, made = build()
        return scene, lambda: made

    def geometry() -> Geometry:
        # The scene may be whole where its geometry, read only now, is not.
        try:
            return read_geometry(path)
        except _UNREADABLE:
            scene, made = build()
            _keep(path, scene, made)
            return made

    with suppress(*_UNREADABLE):
        scene = read_scene(path)
        if scene.name == name:
            return scene, geometry
    scene, made = build()
    return scene, geometry if _keep(path, scene, made) else lambda: made


def _keep(path: Path, scene: Scene, geometry: Geometry) -> bool:
    """Write a file that nobody is to change, and remove older ones; return whether it is there."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)  # a damaged one, which is read-only and not written over
        write_scene(path, scene, geometry, SceneOrigin("bundled"))
        path.chmod(0o444)
    except _UNREADABLE:
        _say_once(f"{path.parent} cannot be written to; name another")
        return False
    for old in path.parent.glob(f"{path.name.split('.')[0]}.*{SUFFIX}"):
        if old != path:
            with suppress(OSError):
                old.unlink()
    return True


@cache
def _say_once(reason: str) -> None:
    print(
        f"scenes are made anew by every command, since {reason} folder in {_VARIABLE}",
        file=sys.stderr,
    )


@cache
def _digest() -> str:
    root = Path(__file__).parents[2]
    digest = hashlib.sha256(" ".join(version(library) for library in _LIBRARIES).encode())
    for source in sorted((*(root / "base").rglob("*.py"), *(root / "models").rglob("*.py"))):
        digest.update(source.relative_to(root).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
