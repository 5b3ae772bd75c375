"""Scenes by name: the bundled ones, or any scene file."""

import difflib
from pathlib import Path

from ..errors import InputError
from .plaza import build_plaza
from .scene import Scene
from .scene_file import read_scene

__all__ = ["SUFFIX", "list_bundled_scenes", "load_scene"]

SUFFIX = ".lodscene"

_BUNDLED = {"plaza": build_plaza}


def list_bundled_scenes() -> tuple[str, ...]:
    """Return the names of the bundled scenes, sorted."""
    return tuple(sorted(_BUNDLED))


def load_scene(spec: str) -> Scene:
    """Return the bundled scene of that name, or the one in the file of that path.

    Raises
    ------
    InputError
        If there is neither, with the nearest bundled name; or if the file is not a scene.
    """
    if spec in _BUNDLED:
        return _BUNDLED[spec]()[0]
    path = Path(spec)
    if path.suffix == SUFFIX or path.is_file():
        return read_scene(path)
    names = list_bundled_scenes()
    near = difflib.get_close_matches(spec, names, n=1)
    hint = f"did you mean {near[0]}?" if near else "name one or give a path"
    raise InputError(
        f"scene: expected one of {', '.join(names)} or a {SUFFIX} file, got {spec}; {hint}"
    )
