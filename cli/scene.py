"""`lodbench scene`: build scenes from meshes, and look at them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .scene_hlod import build_hlod
from .shared.scene_output import check_target, opening, show
from .shared.scene_picture import check_picture, draw_picture

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from ..models.continuous.knots import KnotOptions
    from ..models.layouts.scene_builder import PlacementOptions
    from ..models.meshes.mesh_types import MeshUnits
    from ..models.meshes.simplify import ChainOptions
    from ..models.meshes.type_model import TypeModel
    from ..models.scene.scene_file import SceneOrigin

app = typer.Typer(
    name="scene", help="Build scenes from meshes, and look at them.", no_args_is_help=True
)
app.command("build-hlod")(build_hlod)

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

    from ..base.errors import InputError
    from ..models.continuous.knots import KnotOptions
    from ..models.layouts.scene_builder import PlacementOptions, build_scene
    from ..models.meshes.mesh_types import MeshUnits
    from ..models.meshes.simplify import ChainOptions
    from ..models.scene.scene_file import write_scene

    check_target(out)
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
    show("lodbench.scene-build/1", str(out), scene, origin, as_json=as_json)


@app.command()
def info(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE", help="A bundled scene's name, a scene file, a tileset.json, or glTF."
        ),
    ],
    *,
    picture: Annotated[
        Path | None,
        typer.Option(help="Write a PNG of one frame, coloured by level of detail."),
    ] = None,
    policy: Annotated[
        str | None,
        typer.Option(
            help="Whose levels the picture shows; else static-screen, or in a tree "
            "screen-space-error."
        ),
    ] = None,
    trace: Annotated[str, typer.Option(help="What moves the picture's camera.")] = "tour",
    frame: Annotated[int, typer.Option(help="Frame of the replay to picture.")] = 600,
    hardware: Annotated[
        str, typer.Option(help="The profile that the policy is replayed on.")
    ] = "desktop-assumed",
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Show types, levels of detail with their errors, objects and extent; or a picture of it."""
    from ..models.scene.scene_catalog import open_scene

    if picture is not None:
        check_picture(picture, frame)
    with opening(scene):
        opened = open_scene(scene)
    if picture is not None:
        draw_picture(
            opened,
            picture,
            trace=trace,
            policy=policy,
            frame=frame,
            hardware=hardware,
            budget_ms=budget_ms,
        )
    show("lodbench.scene-info/1", scene, opened.scene, opened.origin, as_json=as_json)


def _read_types(
    meshes: list[Path], units: "MeshUnits", detail: "ChainOptions | KnotOptions"
) -> "list[TypeModel]":
    """Return the types, with a progress bar on stderr where that is a terminal."""
    from rich.console import Console
    from rich.progress import track

    from ..models.meshes.mesh_error import Sampling
    from ..models.meshes.mesh_types import read_types

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

    from ..base.version import __version__
    from ..models.scene.scene_file import SceneOrigin

    options = {"seed": seed, **asdict(units), **asdict(detail), **asdict(placement)}
    sources = tuple(path.name for path in meshes)
    return SceneOrigin(f"lodbench {__version__}", sources, options)
