"""`screen-space-error` held to the traversal of 3DTilesRendererJS on real tilesets.

The peer is given the tiles as our reader understood them: their spheres, their errors and how they
refine, in the frame of the scene, and a content for each.  Loading, error, frustum and traversal
are its own.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.tiles.tileset import read_tileset
from lodbench.policies.thresholds.screen_space_error import ScreenSpaceError
from lodbench.policies.view import View
from lodbench.traces.cameras.orientation import look_along

pytestmark = [pytest.mark.peer, pytest.mark.slow]

FOVY_DEG, WIDTH_PX, HEIGHT_PX, NEAR_M = 60.0, 1280, 720, 0.1
TILESETS = {  # file, and tolerances in px that refine some of it
    "plateau-kumagaya.json": (4.0, 16.0),
    "discrete-lod/tileset.json": (1.0, 16.0),
    "granularities/tileset.json": (1.0, 16.0),
    "request-volume/tileset.json": (16.0,),
}
RunPeer = Callable[[str, dict[str, Any]], Any]


def with_content(scene: Scene) -> Scene:
    """Return a scene in which every tile draws a triangle: contents are not what is tried."""
    levels = scene.types.levels
    counts = np.zeros_like(levels.counts)
    counts[:, LEVEL_PREDICTORS.index("triangles")] = 1.0
    drawn = replace(levels, counts=counts)
    return replace(scene, types=replace(scene.types, levels=drawn))


def replacing(scene: Scene) -> Scene:
    """Return a scene whose tiles replace their parents, and have at most half of their error.

    The peer refines a tile on sight whose error is not below that of the tile above, as 3D Tiles
    asks of tilesets; ours goes by the error that is given (see the test of it).
    """
    error_m = scene.types.levels.error_m.copy()
    for node in range(1, len(scene)):  # parents come first
        error_m[node] = min(error_m[node], 0.5 * error_m[scene.parent[node]])
    types = replace(scene.types, levels=replace(scene.types.levels, error_m=error_m))
    return replace(scene, types=types, additive=np.zeros(len(scene), dtype=np.bool_))


def as_tileset(scene: Scene) -> dict[str, Any]:
    """Return a scene of tiles as a tileset without transforms; contents are called by number."""
    error_m = scene.types.levels.error_m
    tiles: list[dict[str, Any]] = []
    for node, center in enumerate(scene.center_m.tolist()):
        tiles.append(
            {
                "boundingVolume": {"sphere": [*center, float(scene.radius_m[node])]},
                "geometricError": float(error_m[node]),
                "refine": "ADD" if scene.additive[node] else "REPLACE",
                "content": {"uri": f"{node}.glb"},
                "children": [],
            }
        )
        if (parent := int(scene.parent[node])) >= 0:
            tiles[parent]["children"].append(tiles[node])
    return {"asset": {"version": "1.0"}, "geometricError": 1e9, "root": tiles[0]}


def cameras_of(scene: Scene, tolerance_px: float) -> list[Camera]:
    """Return a spiral from where the root is fine enough to a hundredth of its radius."""
    middle, radius_m = scene.center_m[0], float(scene.radius_m[0])
    focal_px = HEIGHT_PX / (2.0 * np.tan(np.radians(FOVY_DEG) / 2.0))
    farthest = 1.5 + 2.0 * float(scene.types.levels.error_m[0]) * focal_px / tolerance_px / radius_m
    found: list[Camera] = []
    for step in range(40):
        turn = 0.4 * step
        away_m = radius_m * farthest * (100.0 * farthest) ** (-step / 39.0)
        position = middle + away_m * np.array((np.cos(turn), np.sin(turn), 0.3))
        aim = middle + 0.2 * radius_m * np.array((np.sin(3.0 * turn), np.cos(2.0 * turn), 0.0))
        ahead = aim - position
        level_m = float(np.hypot(ahead[0], ahead[1]))
        turned = look_along(np.arctan2(ahead[1], ahead[0]), np.arctan2(ahead[2], level_m))
        found.append(
            Camera(
                tuple(position.tolist()), tuple(turned.tolist()),
                WIDTH_PX, HEIGHT_PX, np.radians(FOVY_DEG), NEAR_M,
            )
        )  # fmt: skip
    return found


def ours(
    scene: Scene, cameras: list[Camera], tolerance_px: float, make_view: Callable[..., View]
) -> list[set[int]]:
    """Return the tiles that the policy draws in each frame."""
    policy = ScreenSpaceError(tolerance_px)
    policy.reset(scene, 16.0)
    shown: list[set[int]] = []
    for camera in cameras:
        view = make_view(scene, camera)
        roots = scene.roots
        selection = policy.select(view.at(roots[view.state.inside[roots]]))
        shown.append(set(selection.ids.tolist()))
    return shown


def theirs(
    run_peer: RunPeer, scene: Scene, cameras: list[Camera], tolerance_px: float
) -> list[set[int]]:
    """Return the tiles that the peer shows in each frame."""
    answer = run_peer(
        "tiles_3d.mjs",
        {
            "tileset": as_tileset(scene),
            "cameras": [
                {"position": c.position_m, "orientation_xyzw": c.orientation_xyzw} for c in cameras
            ],
            "fovy_deg": FOVY_DEG,
            "width_px": WIDTH_PX,
            "height_px": HEIGHT_PX,
            "near_m": NEAR_M,
            "tolerance_px": tolerance_px,
        },
    )
    return [set(tiles) for tiles in answer]


def skipped_by_peer(scene: Scene, camera: Camera, tolerance_px: float) -> set[int]:
    """Return what the peer leaves out of what is added to a tile that is fine enough there.

    It measures the parent's error at the child's distance, after CesiumJS; with a child, all below.
    """
    error_m, parent = scene.types.levels.error_m, scene.parent
    away_m = np.linalg.norm(scene.center_m - np.array(camera.position_m), axis=1) - scene.radius_m
    above_px = error_m[parent] * camera.focal_px / np.maximum(away_m, 1e-12)
    skipped = scene.additive[parent] & (parent >= 0) & (error_m > 0.0) & (above_px <= tolerance_px)
    for node in range(len(scene)):  # parents come first
        skipped[node] |= parent[node] >= 0 and skipped[parent[node]]
    return set(np.flatnonzero(skipped).tolist())


@pytest.mark.realdata
@pytest.mark.parametrize("refine", ["as in the file", "REPLACE"])
@pytest.mark.parametrize(
    ("name", "tolerance_px"),
    [(name, tolerance) for name, some in TILESETS.items() for tolerance in some],
)
def test_the_same_tiles_are_drawn(
    run_peer: RunPeer,
    make_view: Callable[..., View],
    data_dir: Path,
    name: str,
    tolerance_px: float,
    refine: str,
) -> None:
    """In every frame of a spiral, but for what the peer leaves out of additive tiles."""
    scene = with_content(read_tileset(data_dir / "tilesets" / name)[0])
    if refine == "REPLACE":
        scene = replacing(scene)
    cameras = cameras_of(scene, tolerance_px)
    drawn = ours(scene, cameras, tolerance_px, make_view)
    shown = theirs(run_peer, scene, cameras, tolerance_px)
    left_out = [skipped_by_peer(scene, camera, tolerance_px) for camera in cameras]
    print(name, tolerance_px, refine, sum(map(len, drawn)), sum(map(len, shown)))
    assert [mine - more for mine, more in zip(drawn, left_out, strict=True)] == shown
    assert len({frozenset(tiles) for tiles in drawn}) > 1


def test_a_tile_no_finer_than_its_parent_is_refined_by_the_peer(
    run_peer: RunPeer,
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
) -> None:
    """Of a chain with errors of 0.6, 0.6 and 0 m the peer never stops at the middle, ours may.

    Spheres have 12, 1 and 1 m.  At 60 m the root's error is 0.6 · 623.5 / 48 = 7.8 px: both draw
    it.  At 30 m it is 20.8, and that of the middle 12.9 of 16: ours draws the middle.
    """
    levels = make_levels([(1.0,), (1.0,), (1.0,)])
    levels = replace(levels, error_m=np.array((0.6, 0.6, 0.0)))
    scene = make_scene(
        [(0.0, 0.0, 0.0)] * 3,
        kind=[0, 1, 2],
        parent=[-1, 0, 1],
        radius_m=[12.0, 1.0, 1.0],
        levels=levels,
    )
    upright = (0.0, 0.0, 0.0, 1.0)
    cameras = [
        Camera((0.0, 0.0, away_m), upright, WIDTH_PX, HEIGHT_PX, np.radians(FOVY_DEG), NEAR_M)
        for away_m in (60.0, 30.0)
    ]
    assert ours(scene, cameras, 16.0, make_view) == [{0}, {1}]
    assert theirs(run_peer, scene, cameras, 16.0) == [{0}, {2}]
