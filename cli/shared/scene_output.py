"""What the commands on scenes have in common: how they write a scene, and how they show one."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...analysis.report.console_tables import titled_table
from ...base.errors import InputError
from ...base.files.writable import require_file_writable

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from collections.abc import Mapping

    from rich.table import Table

    from ...models.meshes.geometry import Geometry
    from ...models.scene.scene import Scene
    from ...models.scene.scene_file import SceneOrigin

_MOST_TYPES = 64  # in a table; --json has them all
_READERS = ("3d-tiles", "gltf", "usd")


def check_output(out: Path, suffix: str) -> None:
    """Refuse, before the work, a file that could not be written or is called something else."""
    if out.suffix.lower() != suffix:
        raise InputError(f"expected a name that ends in {suffix}, got '{out.name}'", path=out)
    if not out.parent.is_dir():
        raise InputError("expected a folder to write to, got none of that name", path=out.parent)
    require_file_writable(out)


def check_scene_options(out: Path, seed: int) -> None:
    """Refuse, before the work, a file that could not be written or found by its name."""
    from ...models.scene.scene_catalog import SUFFIX

    check_output(out, SUFFIX)
    if seed < 0:
        raise InputError(f"seed: expected an integer >= 0, got {seed}")


def write_built(
    out: Path,
    scene: "Scene",
    geometry: "Geometry",
    meshes: list[Path],
    settings: "Mapping[str, str | float | bool | None]",
    *,
    as_json: bool,
) -> None:
    """Write a scene that was made of meshes, with the settings that made it, and show it."""
    from ...base.version import __version__
    from ...models.scene.scene_file import SceneOrigin, write_scene

    sources = tuple(path.name for path in meshes)
    origin = SceneOrigin(f"lodbench {__version__}", sources, settings)
    write_scene(out, scene, geometry, origin)
    show("lodbench.scene-build/1", str(out), scene, origin, as_json=as_json)


def show(schema: str, spec: str, scene: "Scene", origin: "SceneOrigin", *, as_json: bool) -> None:
    """Print a scene in numbers, as tables or as one JSON document."""
    from ...models.scene.scene_summary import summarise

    record = {"schema": schema, "scene": spec, **summarise(scene, origin)}
    if as_json:
        print(json.dumps(record))
    else:
        _print(record)


def _print(record: dict[str, Any]) -> None:
    from rich.console import Console

    console = Console()
    if record["depths"]:
        console.print(_depth_table(record))
    if len(record["types"]) <= _MOST_TYPES:
        console.print(_type_table(record))
    center = ", ".join(f"{value:.1f}" for value in record["extent"]["center_m"])
    size = " by ".join(f"{value:.1f}" for value in record["extent"]["size_m"])
    console.print(
        f"{record['objects']:,} objects, {record['moving']:,} moving; "
        f"{record['triangles']:,} triangles at full detail; extent {size} m about ({center})",
        highlight=False,
        soft_wrap=True,
    )
    settings = record["origin"]["options"]
    if record["origin"]["tool"] in _READERS:  # what was read, and what was not
        line = ", ".join(f"{key.replace('_', ' ')}: {settings[key]}" for key in settings)
        console.print(
            line, highlight=False, soft_wrap=True, markup=False
        )  # names of files are in it


def _depth_table(record: dict[str, Any]) -> "Table":
    columns = ("depth", "nodes", "leaves", "triangles")
    table = titled_table(f"{record['scene']}: nodes by depth", (*columns, "greatest error m"))
    for row in record["depths"]:
        table.add_row(*(f"{row[name]:,}" for name in columns), f"{row['error_m_max']:.3g}")
    return table


def _type_table(record: dict[str, Any]) -> "Table":
    from rich.text import Text

    columns = ("type", "objects", "level", "triangles", "vertices", "draws", "error m", "KiB")
    table = titled_table(f"{record['scene']}: types and levels of detail", columns)
    for kind in record["types"]:
        named = (Text(kind["name"]), f"{kind['objects']:,}")
        for number, level in enumerate(kind["levels"]):
            table.add_row(
                *(named if number == 0 else ("", "")),
                str(number),
                *(f"{level[name]:,}" for name in ("triangles", "vertices", "draw_calls")),
                f"{level['error_m']:.3g}",
                f"{level['bytes'] / 1024:,.1f}",
                end_section=number == len(kind["levels"]) - 1,
            )
    return table
