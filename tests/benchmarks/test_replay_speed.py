"""A full replay under ``static-distance`` against plain numpy that only culls and projects.

The peer computes distance, area and visibility of all objects in every frame, written plainly in
float64, and nothing else: no levels, costs, switches, quality or pipeline.  The aims for a whole
replay, 5,000 frames/s with 3,100 objects and 250 with 100,000, were set where such a peer made
5,240 and 153.  On a machine where the peer is slower than that, the aims shrink alike.
"""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

AIMS = {3_100: (5_000.0, 5_240.0), 100_000: (250.0, 153.0)}  # frames/s, and the peer's
FRAMES = {3_100: 1_500, 100_000: 60}
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


def run_plain(scene: Scene, trace: CameraTrace, times_s: np.ndarray) -> list[int]:
    """Return how many objects are in view at given times."""
    seen: list[int] = []
    for time_s in times_s.tolist():
        pose = trace.pose_at(time_s)
        camera = Camera(
            pose.position_m, pose.orientation_xyzw, WIDTH_PX, HEIGHT_PX, math.radians(FOVY_DEG)
        )
        seen.append(plain_frame(scene.center_m, scene.radius_m, camera).shape[1])
    return seen


def best_s(run: Callable[[], object], rounds: int = 7) -> float:
    """Return the shortest processor time of some runs."""
    times: list[float] = []
    for _ in range(rounds):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


@pytest.mark.parametrize("count", sorted(AIMS))
def test_a_replay_keeps_up_with_plain_culling(
    benchmark: Any,
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_hardware: Callable[..., HardwareProfile],
    count: int,
) -> None:
    """Frames per second of processor time, about a quarter of the objects in view."""
    rng = np.random.default_rng(1)
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
    frames = FRAMES[count]
    options = ReplayOptions(budget_ms=16.0, frames=frames, fovy_deg=FOVY_DEG)

    def whole() -> FrameLog:
        return replay(StaticDistance(), scene, trace, hardware, options, name="static-distance")

    log = whole()
    times_s = log["input_ns"] * 1e-9
    assert run_plain(scene, trace, times_s) == log["visible"].tolist()
    assert 0.15 * count < log["visible"].mean() < 0.35 * count
    own_s, peer_s = best_s(whole), best_s(lambda: run_plain(scene, trace, times_s))
    benchmark.pedantic(whole, rounds=3)
    rate, peer_rate = frames / own_s, frames / peer_s
    benchmark.extra_info.update({"frames_per_s": rate, "plain_frames_per_s": peer_rate})
    aim, reference = AIMS[count]
    aim *= min(1.0, peer_rate / reference)
    print(
        f"\n{count:,} objects, {log['visible'].mean():,.0f} in view: replay {rate:,.0f} frames/s "
        f"(aim {aim:,.0f}), plain culling alone {peer_rate:,.0f}, ratio {rate / peer_rate:.2f}"
    )
    assert rate >= aim
