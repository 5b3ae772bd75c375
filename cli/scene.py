"""`lodbench scene`: build scenes from meshes, and look at them."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from rich.table import Table

    from ..models.build import PlacementOptions
    from ..models.continuous.knots import KnotOptions
    from ..models.mesh_types import MeshUnits
    from ..models.scene import Scene
    from ..models.scene_file import SceneOrigin
    from ..models.simplify import ChainOptions
    from ..models.type_model import TypeModel

_MOST_TYPES = 64  # in a table; --json has them all
_READERS = ("3d-tiles", "gltf")

app = typer.Typer(
    name="scene", help="Build scenes from meshes, and look at them.", no_args_is_help=True
)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]


@app.command()
def build(
    meshes: Annotated[
        list[Path],
        typer.Argument(metavar="MESH...", help="Mesh files, one type each: obj, ply, stl, glb..."),
    ],
    *,
    out: Annotated[Path, typer.Option("--out", help="Scene file to write, *.lodscene.")],
    layout: Annotated[str, typer.Option(help="grid, scatter, rows, city or forest.")] = "scatter",
    count: Annotated[int, typer.Option(help="Objects in all, in equal shares.")] = 500,
    seed: Annotated[int, typer.Option(help="Same seed and meshes, same file.")] = 0,
    levels: Annotated[int, typer.Option(help="Levels at most, the full mesh included.")] = 8,
    ratio: Annotated[float, typer.Option(help="Triangles of a level over the finer one's.")] = 0.5,
    min_triangles: Annotated[int, typer.Option(help="No level aims lower.")] = 32,
    continuous: Annotated[
        bool, typer.Option(help="Continuous types: knots of an ordered mesh, not levels.")
    ] = False,
    knots: Annotated[int, typer.Option(help="Knots at most, if continuous.")] = 12,
    keep_texture: Annotated[
        bool, typer.Option(help="Hold texture seams in place, if continuous.")
    ] = False,
    spacing_m: Annotated[float, typer.Option(help="Free space between bounding spheres.")] = 1.0,
    side_m: Annotated[
        float | None, typer.Option(help="Side of the square; else as large as needed.")
    ] = None,
    scale_variation: Annotated[float, typer.Option(help="Scales are uniform in 1 ± this.")] = 0.0,
    random_yaw: Annotated[bool, typer.Option(help="Turn objects about the vertical.")] = True,
    up: Annotated[str, typer.Option(help="Axis that points up in the files: y or z.")] = "y",
    height_m: Annotated[float, typer.Option(help="Height that each type is scaled to.")] = 2.0,
    unit_m: Annotated[
        float | None, typer.Option(help="Metres of a file unit, instead of --height-m.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Make levels of detail of meshes, place objects, and write one scene file."""
    import numpy as np

    from ..errors import InputError
    from ..models.build import PlacementOptions, build_scene
    from ..models.continuous.knots import KnotOptions
    from ..models.mesh_types import MeshUnits
    from ..models.scene_catalog import SUFFIX
    from ..models.scene_file import write_scene
    from ..models.simplify import ChainOptions

    if out.suffix != SUFFIX:
        raise InputError(f"expected a name that ends in {SUFFIX}, got '{out.name}'", path=out)
    if not out.parent.is_dir():
        raise InputError("expected a folder to write to, got none of that name", path=out.parent)
    if seed < 0:
        raise InputError(f"seed: expected an integer >= 0, got {seed}")
    units = MeshUnits(up=up, height_m=height_m, unit_m=unit_m)
    detail: ChainOptions | KnotOptions = ChainOptions(levels, ratio, min_triangles)
    if continuous:
        detail = KnotOptions(knots, min_triangles, keep_texture)
    placement = PlacementOptions(
        layout=layout,
        count=count,
        spacing_m=spacing_m,
        side_m=side_m,
        scale_variation=scale_variation,
        random_yaw=random_yaw,
    )
    models = _read_types(meshes, units, detail)
    scene, geometry = build_scene(out.stem, models, placement, np.random.default_rng(seed))
    origin = _origin(meshes, seed, units, detail, placement)
    write_scene(out, scene, geometry, origin)
    _show("lodbench.scene-build/1", str(out), scene, origin, as_json=as_json)


@app.command()
def info(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE", help="A bundled scene's name, a scene file, a tileset.json, or glTF."
        ),
    ],
    *,
    as_json: Json = False,
) -> None:
    """Show types, levels of detail with their errors, objects and extent."""
    from ..models.scene_catalog import open_scene

    opened = open_scene(scene)
    _show("lodbench.scene-info/1", scene, opened.scene, opened.origin, as_json=as_json)


def _read_types(
    meshes: list[Path], units: "MeshUnits", detail: "ChainOptions | KnotOptions"
) -> "list[TypeModel]":
    """Return the types, with a progress bar on stderr where that is a terminal."""
    from rich.console import Console
    from rich.progress import track

    from ..models.mesh_error import Sampling
    from ..models.mesh_types import read_types

    console = Console(stderr=True)
    return list(
        track(
            read_types(meshes, units, detail, Sampling()),
            description="levels of detail",
            total=len(meshes),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
    )


def _origin(
    meshes: list[Path],
    seed: int,
    units: "MeshUnits",
    detail: "ChainOptions | KnotOptions",
    placement: "PlacementOptions",
) -> "SceneOrigin":
    from dataclasses import asdict

    from .. import __version__
    from ..models.scene_file import SceneOrigin

    options = {"seed": seed, **asdict(units), **asdict(detail), **asdict(placement)}
    sources = tuple(path.name for path in meshes)
    return SceneOrigin(f"lodbench {__version__}", sources, options)


def _show(schema: str, spec: str, scene: "Scene", origin: "SceneOrigin", *, as_json: bool) -> None:
    from ..models.scene_summary import summarise

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
