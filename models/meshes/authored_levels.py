"""Levels of detail that artists made: which files are one type, by their names.

Unity and Unreal call them ``rock_LOD0``, ``rock_LOD1``; Godot's and Blender's exporters write
``rock-lod1`` or ``rock.lod1``; some count from 1.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError

LEVEL_NAME = re.compile(r"(?P<name>.+?)[ _.-]*lod[ _.-]?(?P<level>\d{1,2})", re.IGNORECASE)
"""A name with the number of its level, of a file or of a node in one."""


@dataclass(frozen=True, slots=True)
class MeshGroup:
    """The files of one type.

    Attributes
    ----------
    name : str
    paths : tuple of Path
        Finest first; a single one has its levels made.
    """

    name: str
    paths: tuple[Path, ...]


def group_levels(paths: Sequence[Path]) -> list[MeshGroup]:
    """Return the types of mesh files, in the order in which their first files are given.

    Raises `InputError` if a level is missing among a type's, or comes twice.
    """
    found: dict[str, list[tuple[int, Path]]] = {}
    for path in paths:
        match = LEVEL_NAME.fullmatch(path.stem)
        if match is None:
            found[f"{len(found)}:{path.stem}"] = [(0, path)]
        else:
            # Without its level a name may be that of another file, which is a type of its own.
            key = f"lod:{path.parent}:{match['name']}:{path.suffix}"
            found.setdefault(key, []).append((int(match["level"]), path))
    groups: list[MeshGroup] = []
    for files in found.values():
        files.sort(key=lambda pair: pair[0])
        levels = [level for level, _ in files]
        if levels != list(range(levels[0], levels[0] + len(files))) or levels[0] > 1 < len(files):
            raise InputError(
                f"expected levels one after the other from LOD0, got {levels}; name the missing "
                "file, or rename those that are no levels",
                path=files[0][1],
            )
        match = LEVEL_NAME.fullmatch(files[0][1].stem) if len(files) > 1 else None
        name = files[0][1].stem if match is None else match["name"]
        groups.append(MeshGroup(name, tuple(path for _, path in files)))
    return groups
