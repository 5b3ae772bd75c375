"""`lodbench scene`: build scenes from meshes, and look at them."""

import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option, Typer

from ..base.errors import printable
from .scene_hlod import build_hlod
from .shared import options
from .shared.frame_picture import check_picture, draw_picture
from .shared.progress import progress_bar
from .shared.scene_output import check_scene_options, show, write_built
from .shared.terminal import open_named_scene

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from ..models.continuous.knots import KnotOptions
    from ..models.meshes.authored_levels import MeshGroup
    from ..models.meshes.mesh_types import MeshUnits
    from ..models.meshes.simplify import ChainOptions
    from ..models.meshes.type_model import TypeModel

app = Typer(
    name="scene",
    help="Build scenes from meshes, and look at them.",
    no_args_is_help=True,
    add_completion=False,
)
app.command("build-hlod")(build_hlod)

_WIDE_M, _FLAT = 50.0, 20.0
_SHOWN = 4

Placements = Annotated[
    Path | None,
    Option(
        metavar="FILE",
        help="CSV or JSON with the type, place, turn, scale and importance of every object, in the "
        "meshes' axes and unit; instead of a layout.",
    ),
]
Ratio = Annotated[float, Option(help="Triangles of a level over the finer one's.")]
MinTriangles = Annotated[int, Option(help="No level aims lower.")]
Continuous = Annotated[bool, Option(help="Continuous types: knots of an ordered mesh, not levels.")]
Knots = Annotated[int, Option(help="Knots at most, if continuous.")]
KeepTexture = Annotated[bool, Option(help="Hold texture seams in place, if continuous.")]
Count = Annotated[int, Option(help="Objects in all, in equal shares.")]
ScaleVariation = Annotated[float, Option(help="Scales are uniform in 1 ± this.")]
SceneName = Annotated[
    str,
    Argument(
        metavar="SCENE", help="A bundled scene's name, a scene file, a tileset.json, or glTF."
    ),
]
Picture = Annotated[
    Path | None, Option(help="Write a PNG of one frame, coloured by level of detail.")
]
PicturePolicy = Annotated[
    str | None,
    Option(
        help="Whose levels the picture shows; else static-screen, or in a tree screen-space-error."
    ),
]
PictureTrace = Annotated[str, Option(help="What moves the picture's camera.")]
Frame = Annotated[int, Option(help="Frame of the replay to picture.")]
PictureHardware = Annotated[str, Option(help="The profile that the policy is replayed on.")]


@app.command()
def build(
    meshes: options.Meshes,
    *,
    out: options.SceneOut,
    layout: options.Layout = "scatter",
    count: Count = 500,
    seed: options.MeshSeed = 0,
    levels: options.Levels = 8,
    ratio: Ratio = 0.5,
    min_triangles: MinTriangles = 32,
    continuous: Continuous = False,
    knots: Knots = 12,
    keep_texture: KeepTexture = False,
    spacing_m: options.SpacingM = 1.0,
    side_m: options.SideM = None,
    scale_variation: ScaleVariation = 0.0,
    random_yaw: options.RandomYaw = True,
    up: options.Up = "y",
    height_m: options.HeightM = 2.0,
    unit_m: options.UnitM = None,
    placements: Placements = None,
    as_json: options.AsJson = False,
) -> None:
    """Make levels of detail of meshes, place objects, and write one scene file.

    Files called as levels, such as rock_LOD0.obj and rock_LOD1.obj, are one type with these levels,
    and so is a glTF file whose nodes have levels.
    """
    import numpy as np

    from ..models.continuous.knots import KnotOptions
    from ..models.layouts.placements_file import read_placements
    from ..models.layouts.scene_builder import PlacementOptions, build_scene, scene_of_placements
    from ..models.meshes.authored_levels import group_levels
    from ..models.meshes.mesh_types import MeshUnits
    from ..models.meshes.simplify import ChainOptions

    check_scene_options(out, seed)
    units = MeshUnits(up=up, height_m=height_m, unit_m=unit_m)
    if placements is not None:  # meshes stay as the engine has them
        units = replace(units, unit_m=unit_m or 1.0, keep_origin=True)
    groups = group_levels(meshes)
    detail: ChainOptions | KnotOptions = ChainOptions(levels, ratio, min_triangles)
    if continuous:
        detail = KnotOptions(knots, min_triangles, keep_texture)
    placement = PlacementOptions(
        layout, count, spacing_m, side_m, scale_variation, random_yaw=random_yaw
    )
    models = _read_types(groups, units, detail)
    _warn_of_sizes(models, units)
    settings = {"seed": seed, **asdict(units), **asdict(detail), **asdict(placement)}
    if placements is None:
        scene, geometry = build_scene(out.stem, models, placement, np.random.default_rng(seed))
    else:
        names = [group.name for group in groups]
        where = read_placements(placements, names, y_up=up == "y", unit_m=unit_m or 1.0)
        if where.unused:
            _warn_of_unused(placements, where.unused)
        scene, geometry = scene_of_placements(out.stem, models, where)
        settings |= {"layout": f"placements of {placements.name}", "count": len(scene)}
    write_built(out, scene, geometry, meshes, settings, as_json=as_json)


@app.command()
def info(
    scene: SceneName,
    *,
    picture: Picture = None,
    policy: PicturePolicy = None,
    trace: PictureTrace = "tour",
    frame: Frame = 600,
    hardware: PictureHardware = "desktop-assumed",
    budget_ms: options.BudgetMs = None,
    as_json: options.AsJson = False,
) -> None:
    """Show types, levels of detail with their errors, objects and extent; or a picture of it."""
    if picture is not None:
        check_picture(picture, frame)
    opened = open_named_scene(scene)
    if picture is not None:
        draw_picture(opened, picture, trace, policy, frame, hardware, budget_ms)
    show("lodbench.scene-info/1", scene, opened.scene, opened.origin, as_json=as_json)


def _warn_of_unused(placements: Path, unused: tuple[str, ...]) -> None:
    """Tell of columns that say nothing to us: a turn or a scale may be among them."""
    more = f" and {len(unused) - _SHOWN} more" if len(unused) > _SHOWN else ""
    print(
        f"warning: {printable(placements.name)}: not used: {', '.join(unused[:_SHOWN])}{more}; "
        "type, x y z, qx qy qz qw, yaw_deg, scale, importance are",
        file=sys.stderr,
    )


def _warn_of_sizes(models: "list[TypeModel]", units: "MeshUnits") -> None:
    """Tell of meshes that a given height made far wider than high, such as a plate."""
    if units.unit_m is not None:
        return
    for model in models:
        width_m = 2.0 * model.radius_m
        if width_m > _WIDE_M and width_m > _FLAT * units.height_m:
            print(
                f"warning: {model.name}: {width_m:,.0f} m wide at {units.height_m:g} m height; is "
                "another axis up, or does --unit-m say more?",
                file=sys.stderr,
            )


def _read_types(
    meshes: "list[MeshGroup]", units: "MeshUnits", detail: "ChainOptions | KnotOptions"
) -> "list[TypeModel]":
    from ..models.meshes.mesh_error import Sampling
    from ..models.meshes.mesh_types import read_types

    models: list[TypeModel] = []
    with progress_bar("levels of detail", "meshes") as progress:
        for model in read_types(meshes, units, detail, Sampling()):
            models.append(model)
            progress(len(models), len(meshes))
    return models
