"""`lodbench scene build-hlod`: trees of pieces of meshes, as in the HLOD thesis."""

from dataclasses import asdict
from typing import Annotated

from typer import Option

from .shared import options
from .shared.scene_output import check_scene_options, write_built

DesiredTriangles = Annotated[int, Option(help="Triangles wanted in each node.")]
LevelFactor = Annotated[
    int, Option(help="Pieces of a node, and triangles of a level over the coarser's.")
]
Count = Annotated[int | None, Option(help="Trees in all, in equal shares; else one of each mesh.")]


def build_hlod(
    meshes: options.Meshes,
    *,
    out: options.SceneOut,
    desired_triangles: DesiredTriangles = 900,
    level_factor: LevelFactor = 4,
    max_levels: options.Levels = 8,
    layout: options.Layout = "grid",
    count: Count = None,
    seed: options.MeshSeed = 0,
    spacing_m: options.SpacingM = 1.0,
    side_m: options.SideM = None,
    random_yaw: options.RandomYaw = True,
    up: options.Up = "y",
    height_m: options.HeightM = 2.0,
    unit_m: options.UnitM = None,
    as_json: options.AsJson = False,
) -> None:
    """Cut each mesh into a tree of ever finer and smaller pieces, and write one scene file."""
    import numpy as np

    from ..models.hlod import hlod_tree
    from ..models.hlod.hlod_scene import place_trees
    from ..models.layouts.scene_builder import PlacementOptions
    from ..models.meshes.mesh_error import Sampling
    from ..models.meshes.mesh_types import MeshUnits, read_surface

    check_scene_options(out, seed)
    units = MeshUnits(up=up, height_m=height_m, unit_m=unit_m)
    pieces = hlod_tree.HlodOptions(desired_triangles, level_factor, max_levels)
    placement = PlacementOptions(
        layout, len(meshes) if count is None else count, spacing_m, side_m, random_yaw=random_yaw
    )
    trees = [hlod_tree.build_hlod(read_surface(path, units), pieces, Sampling()) for path in meshes]
    scene, geometry = place_trees(out.stem, trees, placement, np.random.default_rng(seed))
    settings = {"seed": seed, **asdict(units), **asdict(pieces), **asdict(placement)}
    write_built(out, scene, geometry, meshes, settings, as_json=as_json)
