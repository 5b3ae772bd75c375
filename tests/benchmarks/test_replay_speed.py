"""Replays against plain numpy that only culls and projects, along the same path in the same run.

The peer computes distance, area and visibility of all objects in every frame, written plainly in
float64, and nothing else: no levels, costs, switches, quality or pipeline.  Aims are shares of its
frames per second of processor time, never absolute rates, which differ threefold among machines.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

PLAZA_AIMS = {
    "static-screen": 1.0,
    "full": 1.0,
    "static-distance": 1.0,
    "feedback": 0.8,
    "lodmanager": 0.8,
    "gobbetti": 0.5,
    "wimmer": 0.5,
    "funkhouser": 0.35,
    "zach": 0.35,
}
"""Least frames/s on `plaza` along `tour`, 3,000 objects, over the peer's."""

LARGE_AIM = 4.0  # of 100,000 objects under `static-screen`
LARGE_OBJECTS, LARGE_FRAMES = 100_000, 60
WIDTH_PX, HEIGHT_PX, FOVY_DEG = 1280, 720, 60.0


def plain_frame(centers_m: np.ndarray, radius_m: np.ndarray, camera: Camera) -> np.ndarray:
    """Return ids, distances and areas of the spheres in view, as one writes it first."""
    offset = centers_m - np.array(camera.position_m)
    x, y, z = np.einsum("ij,nj->in", camera.axes, offset)  # not BLAS: one core, as for the replay
    distance = np.sqrt(x**2 + y**2 + z**2)
    half_x = math.atan(0.5 * camera.width_px / camera.focal_px)
    half_y = math.atan(0.5 * camera.height_px / camera.focal_px)
    inside = z > camera.near_m - radius_m
    for side, half in ((x, half_x), (y, half_y)):
        inside &= z * math.sin(half) - side * math.cos(half) >= -radius_m
        inside &= z * math.sin(half) + side * math.cos(half) >= -radius_m
    with np.errstate(invalid="ignore", divide="ignore"):
        gap = z**2 - radius_m**2
        area = np.pi * (camera.focal_px * radius_m) ** 2 / gap
        area = area * np.sqrt((distance**2 - radius_m**2) / gap)
    area = np.where(z - radius_m < camera.near_m, camera.viewport_px, area)
    area = np.minimum(area, camera.viewport_px)
    ids = np.flatnonzero(inside)
    return np.stack((ids, distance[ids], area[ids]))


def run_plain(
    scene: Scene, trace: CameraTrace, times_s: np.ndarray, width_px: int, height_px: int
) -> list[int]:
    """Return how many objects are in view at given times."""
    seen: list[int] = []
    for time_s in times_s.tolist():
        pose = trace.pose_at(time_s)
        camera = Camera(
            pose.position_m, pose.orientation_xyzw, width_px, height_px, math.radians(FOVY_DEG)
        )
        seen.append(plain_frame(scene.center_m, scene.radius_m, camera).shape[1])
    return seen


def rates(
    name: str,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    *,
    frames: int | None = None,
    rounds: int = 5,
) -> tuple[FrameLog, float, float]:
    """Return a log, and frames per second of processor time of the replay and of the peer.

    Both are the best of some rounds that take turns, so that a busy moment slows both.
    """
    options = ReplayOptions(budget_ms=16.0, frames=frames, fovy_deg=FOVY_DEG)
    display = hardware.display

    def whole() -> FrameLog:
        return replay(parse_policy(name).make(), scene, trace, hardware, options, name=name)

    log = whole()
    times_s = log["input_ns"] * 1e-9
    own_s, peer_s = math.inf, math.inf
    for _ in range(rounds):
        start = time.process_time()
        whole()
        middle = time.process_time()
        run_plain(scene, trace, times_s, display.width_px, display.height_px)
        own_s = min(own_s, middle - start)
        peer_s = min(peer_s, time.process_time() - middle)
    rate, peer_rate = len(log) / own_s, len(log) / peer_s
    print(
        f"\n{name}: {len(scene):,} objects, {log['visible'].mean():,.0f} in view: {rate:,.0f} "
        f"frames/s, plain culling alone {peer_rate:,.0f}, ratio {rate / peer_rate:.2f}"
    )
    return log, rate, peer_rate


@pytest.mark.parametrize("name", PLAZA_AIMS)
def test_a_replay_of_plaza_keeps_up_with_plain_culling(benchmark: Any, name: str) -> None:
    """Frames along the whole tour at 60 Hz, in which 40 % of the objects are in view."""
    scene, hardware = load_scene("plaza"), load_hardware("desktop-assumed")
    hardware = replace(hardware, display=replace(hardware.display, mode="vsync"))
    log, rate, peer_rate = rates(name, scene, load_trace("tour", scene), hardware)
    assert 0.25 * len(scene) < log["visible"].mean() < 0.5 * len(scene)
    benchmark.extra_info.update({"frames_per_s": rate, "plain_frames_per_s": peer_rate})
    benchmark.pedantic(lambda: None)
    assert rate / peer_rate >= PLAZA_AIMS[name]


def test_a_replay_of_many_objects_outruns_plain_culling(
    benchmark: Any,
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_hardware: Callable[..., HardwareProfile],
) -> None:
    """100,000 objects at rest, about a quarter of them in view: the peer counts the same ones."""
    rng, count = np.random.default_rng(1), LARGE_OBJECTS
    scene = make_scene(
        np.column_stack([rng.uniform(-200.0, 200.0, (count, 2)), np.ones(count)]),
        kind=rng.integers(0, 4, count),
        levels=make_levels([(4000 * k, 1500 * k, 500 * k, 150 * k, 40 * k) for k in (1, 2, 3, 4)]),
    )
    hardware = make_hardware(
        {"triangles": 5e-6, "draw_calls": 5e-4, "shaded_samples": 1e-7},
        cpu={"draw_calls": 1.5e-3},
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
    )
    trace = generate("walk", duration_s=120.0, extent_m=80.0, seed=3)
    log, rate, peer_rate = rates("static-screen", scene, trace, hardware, frames=LARGE_FRAMES)
    times_s = log["input_ns"] * 1e-9
    assert run_plain(scene, trace, times_s, WIDTH_PX, HEIGHT_PX) == log["visible"].tolist()
    assert 0.15 * count < log["visible"].mean() < 0.35 * count
    benchmark.extra_info.update({"frames_per_s": rate, "plain_frames_per_s": peer_rate})
    benchmark.pedantic(lambda: None)
    assert rate / peer_rate >= LARGE_AIM
