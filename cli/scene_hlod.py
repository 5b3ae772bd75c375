"""`lodbench scene build-hlod`: trees of pieces of meshes, as in the HLOD thesis."""

from pathlib import Path
from typing import Annotated

import typer

from .shared.scene_output import check_target, show


def build_hlod(
    meshes: Annotated[
        list[Path],
        typer.Argument(metavar="MESH...", help="Mesh files, one tree each: obj, ply, stl, glb..."),
    ],
    *,
    out: Annotated[Path, typer.Option("--out", help="Scene file to write, *.lodscene.")],
    desired_triangles: Annotated[int, typer.Option(help="Triangles wanted in each node.")] = 900,
    level_factor: Annotated[
        int, typer.Option(help="Pieces of a node, and triangles of a level over the coarser's.")
    ] = 4,
    max_levels: Annotated[int, typer.Option(help="Levels at most, the full mesh included.")] = 8,
    layout: Annotated[str, typer.Option(help="grid, scatter, rows, city or forest.")] = "grid",
    count: Annotated[
        int | None, typer.Option(help="Trees in all, in equal shares; else one of each mesh.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Same seed and meshes, same file.")] = 0,
    spacing_m: Annotated[float, typer.Option(help="Free space between bounding circles.")] = 1.0,
    side_m: Annotated[
        float | None, typer.Option(help="Side of the square; else as large as needed.")
    ] = None,
    random_yaw: Annotated[bool, typer.Option(help="Turn trees about the vertical.")] = True,
    up: Annotated[str, typer.Option(help="Axis that points up in the files: y or z.")] = "y",
    height_m: Annotated[float, typer.Option(help="Height that each mesh is scaled to.")] = 2.0,
    unit_m: Annotated[
        float | None, typer.Option(help="Metres of a file unit, instead of --height-m.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Cut each mesh into a tree of ever finer and smaller pieces, and write one scene file."""
    from dataclasses import asdict

    import numpy as np

    from ..base.errors import InputError
    from ..base.version import __version__
    from ..models.hlod.hlod_scene import place_trees
    from ..models.hlod.hlod_tree import HlodOptions
    from ..models.hlod.hlod_tree import build_hlod as build
    from ..models.layouts.scene_builder import PlacementOptions
    from ..models.meshes.mesh_error import Sampling
    from ..models.meshes.mesh_types import MeshUnits, read_surface
    from ..models.scene.scene_file import SceneOrigin, write_scene

    check_target(out)
    if seed < 0:
        raise InputError(f"seed: expected an integer >= 0, got {seed}")
    units = MeshUnits(up=up, height_m=height_m, unit_m=unit_m)
    options = HlodOptions(desired_triangles, level_factor, max_levels)
    placement = PlacementOptions(
        layout, len(meshes) if count is None else count, spacing_m, side_m, random_yaw=random_yaw
    )
    trees = [build(read_surface(path, units), options, Sampling()) for path in meshes]
    scene, geometry = place_trees(out.stem, trees, placement, np.random.default_rng(seed))
    settings = {"seed": seed, **asdict(units), **asdict(options), **asdict(placement)}
    sources = tuple(path.name for path in meshes)
    origin = SceneOrigin(f"lodbench {__version__}", sources, settings)
    write_scene(out, scene, geometry, origin)
    show("lodbench.scene-build/1", str(out), scene, origin, as_json=as_json)
