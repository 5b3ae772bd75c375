"""Figure 5: the picture with the manager and that without, at one and the same view."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.continuous.collapse_steps import CollapseSteps
from ....models.continuous.knots import OrderedSurface
from ....models.scene.camera import Camera
from ....models.scene.rotation import rotate
from ....models.scene.scene_catalog import load_scene
from ....models.scenes.ogres import ogre_surface
from ....policies.registry import parse_policy
from ....policies.shared.observer import watch
from ....policies.view import View
from ....render.pictures.raster import Canvas
from ....sim.replay import replay
from ....sim.replay_options import ReplayOptions
from ...study.engine.task import Beat
from ...study.stages import find_stage
from ..experiment import Claim, Constant, Experiment, Findings, verdict_of
from ..trial import Numbers, Trial, trial
from .machine import CHANGED_NS, CONSTANTS, FAR_M, NEAR_M, machine, manager

_PATHS = ("drive", "walk")
_SEEDS, _AT_S = 5, 6.0
_WIDTH_PX, _HEIGHT_PX = 800, 600
_LIGHT = np.array((-0.45, -0.35, 0.82))
_SKY, _OGRE, _DARK = 0.85, 0.7, 0.15  # grey, 0 is black; and the share of it without light
_MOST_TRIANGLES = 400_000  # drawn at once


def measure(*, path: str, seed: int, seconds: float, beat: Beat) -> Numbers:
    """Return how many pixels differ between both selections of the last frame of a path."""
    scene = load_scene("ogres")
    trace = find_stage(scene).move(path, seconds, seed)
    spec = parse_policy(manager())
    watched = watch(spec.make())
    hardware = machine(0.0, CHANGED_NS, whole=False)
    replay(
        watched, scene, trace, hardware, ReplayOptions(budget_ms=33.3), name=spec.label, beat=beat
    )
    view, selection = watched.last
    assert view is not None
    assert selection is not None
    lod = np.clip((FAR_M - view.distance_m) / (FAR_M - NEAR_M), 0.0, 1.0)
    low = scene.types.levels.min_resolution[view.type_index]
    surface, steps = ogre_surface(), CollapseSteps(scene.types.levels)
    pictures: list[FloatArray] = []
    triangles: list[float] = []
    for detail in (selection.detail, low + lod * (1.0 - low)):
        step = steps.level(view.type_index, detail)
        count = steps.triangles(view.type_index, step).astype(np.int64)
        triangles.append(float(count.sum()))
        pictures.append(_draw(view, count, surface))
    one, other = (np.round(255.0 * picture) for picture in pictures)
    change = np.abs(one - other)
    return {
        "any_pct": 100.0 * float((change > 0.0).mean()),
        "above_8_pct": 100.0 * float((change > 8.0).mean()),
        "above_32_pct": 100.0 * float((change > 32.0).mean()),
        "covered_pct": 100.0 * float((other != np.round(255.0 * _SKY)).mean()),
        "objects": len(view.ids),
        "triangles_pct": 100.0 * (triangles[0] / triangles[1] - 1.0),
    }


def _draw(view: View, count: IntArray, surface: OrderedSurface) -> FloatArray:
    """Return grey values of a picture in which each object has so many triangles, (H, W)."""
    frame = view.camera
    camera = Camera(
        frame.position_m, frame.orientation_xyzw, _WIDTH_PX, _HEIGHT_PX, np.radians(60.0)
    )
    canvas = Canvas(np.full((_HEIGHT_PX, _WIDTH_PX, 3), _SKY))
    for triangles in np.unique(count).tolist():
        faces, _, _ = surface.extract(triangles)
        nodes = view.ids[count == triangles]
        batch = max(1, _MOST_TRIANGLES // len(faces))
        for first in range(0, len(nodes), batch):
            corner = _corners(view, camera, nodes[first : first + batch], surface, faces)
            corner = corner[(corner[:, :, 2] > camera.near_m).all(axis=1)]
            canvas.draw(_project(corner, camera), _shade(corner, camera))
    return canvas.color[:, :, 0].astype(np.float64)


def _corners(
    view: View, camera: Camera, nodes: IntArray, surface: OrderedSurface, faces: IntArray
) -> FloatArray:
    """Return corners in the camera's frame, (n, 3, 3)."""
    scene, points = view.scene, surface.full.positions
    turn = np.repeat(scene.orientation_xyzw[nodes], len(points), axis=0)
    turned: Any = rotate(turn, np.tile(points, (len(nodes), 1)))
    placed = turned.reshape(len(nodes), len(points), 3) * scene.scale[nodes, None, None]
    placed += scene.position_m[nodes, None]
    seen = camera.to_camera(placed.reshape(-1, 3).T).T.reshape(len(nodes), len(points), 3)
    return seen[:, faces].reshape(-1, 3, 3)


def _project(corner: FloatArray, camera: Camera) -> FloatArray:
    depth = corner[:, :, 2:]
    middle = np.array((_WIDTH_PX / 2.0, _HEIGHT_PX / 2.0))
    plane = middle + corner[:, :, :2] * (camera.focal_px / depth) * (1.0, -1.0)
    return np.concatenate((plane, depth), axis=2)


def _shade(corner: FloatArray, camera: Camera) -> FloatArray:
    """Return greys of flat triangles under one light; both sides are lit alike."""
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-30)
    facing = np.einsum("ij,ij->i", normal, corner[:, 0]) > 0.0
    light = camera.axes @ (_LIGHT / np.linalg.norm(_LIGHT))
    cosine = np.where(facing, -1.0, 1.0) * (normal @ light) / length
    bright = _DARK + (1.0 - _DARK) * np.maximum(cosine, 0.0)
    return np.repeat((_OGRE * bright)[:, None], 3, axis=1)


def _trials(reduced: bool) -> Sequence[Trial]:
    return [
        trial(
            f"{path}, seed {seed}",
            "gumbau.fig5:measure",
            {"path": path, "seed": seed, "seconds": 2.0 if reduced else _AT_S},
        )
        for path in (_PATHS[:1] if reduced else _PATHS)
        for seed in range(1 if reduced else _SEEDS)
    ]


def _judge(numbers: Mapping[str, Numbers], _reduced: bool) -> Findings:
    worst = {
        name: max(one[name] for one in numbers.values())
        for name in ("any_pct", "above_8_pct", "above_32_pct")
    }
    mean = {
        name: float(np.mean([one[name] for one in numbers.values()]))
        for name in ("any_pct", "above_8_pct", "above_32_pct", "covered_pct", "objects")
    }
    holds = worst["any_pct"] < 1.0 and worst["above_32_pct"] < 0.1
    claims = (
        Claim(
            "visual differences are almost imperceptible",
            "picture of differences, without numbers",
            f"pixels that differ at all: mean {mean['any_pct']:.2f} %, at most "
            f"{worst['any_pct']:.2f} %; by more than 8 of 255: {mean['above_8_pct']:.2f} %, "
            f"{worst['above_8_pct']:.2f} %; by more than 32: {mean['above_32_pct']:.3f} %, "
            f"{worst['above_32_pct']:.3f} %",
            "1 % at all, 0.1 % by more than 32",
            verdict_of(
                holds,
                f"{worst['any_pct']:.1f} % differ at all, {worst['above_32_pct']:.2f} % by more "
                "than 32: another level moves silhouettes and edges of flat shading",
                direction=worst["above_32_pct"] < 1.0,
            ),
        ),
    )
    notes = (
        (
            f"{mean['objects']:.0f} ogres in view cover {mean['covered_pct']:.0f} % of the "
            "picture.  They are flat in colour for each triangle, from 27 to 179 of 255 by one "
            "light, and drawn with one sample a pixel: this shows more than smooth shading and "
            "textures would."
        ),
    )
    return Findings(claims, (), notes)


FIG5 = Experiment(
    id="gumbau/fig5",
    title="the picture with and without the manager",
    setting=f"`ogres`, the view after {_AT_S:g} s of `drive` and `walk`, {_SEEDS} seeds; both "
    f"selections drawn at their true collapse steps, {_WIDTH_PX} by {_HEIGHT_PX} pixels.",
    constants={
        name: one for name, one in CONSTANTS.items() if name in ("ogres", "slots N_T", "range")
    }
    | {
        "picture": Constant(f"{_WIDTH_PX} by {_HEIGHT_PX}, flat shading", "assumed", "not printed"),
    },
    trials=_trials,
    judge=_judge,
)
