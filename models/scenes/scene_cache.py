"""Generated scenes on disk, so that each is made once.

A file is named after its scene and a digest of what it is made by: the sources of this package's
models and the version of numpy.  So it is never stale, and files of older digests are removed.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from ...base.errors import InputError
from ..meshes.geometry import Geometry
from ..scene.scene import Scene
from ..scene.scene_file import SceneOrigin, write_scene

_VARIABLE = "LODBENCH_CACHE"


def cache_folder() -> Path:
    """Return where generated scenes are kept: ``LODBENCH_CACHE``, or the platform's cache."""
    named = os.environ.get(_VARIABLE)
    if named:
        return Path(named)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "lodbench"
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return (Path(base) if base else Path.home() / "AppData" / "Local") / "lodbench" / "Cache"
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "lodbench"


def cached_scene(name: str, suffix: str, build: Callable[[], tuple[Scene, Geometry]]) -> Path:
    """Return the file of a generated scene, made now if it is not there yet.

    Raises `InputError` if the cache cannot be written to.
    """
    folder = cache_folder()
    path = folder / f"{name}.{_digest()}{suffix}"
    if path.is_file():
        return path
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scene, geometry = build()
        write_scene(path, scene, geometry, SceneOrigin("bundled"))
    except OSError as error:
        raise InputError(
            f"expected a folder to keep generated scenes in, got {error.strerror}; "
            f"name another in {_VARIABLE}",
            path=folder,
        ) from error
    for old in folder.glob(f"{name}.*{suffix}"):
        if old != path:
            old.unlink(missing_ok=True)
    return path


@cache
def _digest() -> str:
    folder = Path(__file__).parents[1]
    digest = hashlib.sha256(np.__version__.encode())
    for source in sorted(folder.rglob("*.py")):
        digest.update(source.relative_to(folder).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
