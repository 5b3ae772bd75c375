"""What the commands on scenes have in common: where they write, and how they show a scene."""

import json
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from collections.abc import Generator

    from rich.table import Table

    from ...models.scene.scene import Scene
    from ...models.scene.scene_file import SceneOrigin

_MOST_TYPES = 64  # in a table; --json has them all
_READERS = ("3d-tiles", "gltf")


def check_target(out: Path) -> None:
    """Raise InputError unless a scene can be written there and found by its name."""
    from ...base.errors import InputError
    from ...models.scene.scene_catalog import SUFFIX

    if out.suffix != SUFFIX:
        raise InputError(f"expected a name that ends in {SUFFIX}, got '{out.name}'", path=out)
    if not out.parent.is_dir():
        raise InputError("expected a folder to write to, got none of that name", path=out.parent)


@contextmanager
def opening(spec: str) -> "Generator[None]":
    """Tell on stderr, where that is a terminal, that a scene is opened, or made at first."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield
        return
    with console.status(f"opening {spec}; bundled scenes are made the first time"):
        yield


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
    lines = [
        (
            f"{record['objects']:,} objects, {record['moving']:,} moving; "
            f"{record['triangles']:,} triangles at full detail; extent {size} m about ({center})"
        )
    ]
    options = record["origin"]["options"]
    if record["origin"]["tool"] in _READERS:  # what was read, and what was not
        lines.append(", ".join(f"{key.replace('_', ' ')}: {options[key]}" for key in options))
    for line in lines:
        console.print(line, highlight=False, soft_wrap=True)


def _depth_table(record: dict[str, Any]) -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(f"{record['scene']}: nodes by depth"))
    for name in ("depth", "nodes", "leaves", "triangles", "greatest error m"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in record["depths"]:
        numbers = (f"{row[name]:,}" for name in ("depth", "nodes", "leaves", "triangles"))
        table.add_row(*numbers, f"{row['error_m_max']:.3g}")
    return table


def _type_table(record: dict[str, Any]) -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(f"{record['scene']}: types and levels of detail"))
    table.add_column("type", overflow="fold")
    for name in ("objects", "level", "triangles", "vertices", "draws", "error m", "KiB"):
        table.add_column(name, justify="right", no_wrap=True)
    for kind in record["types"]:
        for number, level in enumerate(kind["levels"]):
            first = number == 0
            table.add_row(
                Text(kind["name"] if first else ""),
                f"{kind['objects']:,}" if first else "",
                str(number),
                *(f"{level[name]:,}" for name in ("triangles", "vertices", "draw_calls")),
                f"{level['error_m']:.3g}",
                f"{level['bytes'] / 1024:,.1f}",
                end_section=number == len(kind["levels"]) - 1,
            )
    return table
