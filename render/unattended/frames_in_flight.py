"""Throughput and lag with several frames in flight in open loop: no policy, no Python between.

``python -m lodbench.render.unattended.frames_in_flight SCENE WIDTHxHEIGHT each|instanced FRAMES``
draws up to 60 of so many frames of calibration and prints a JSON document: medians of frames that
are waited for one by one, then for 1 to 4 frames in flight the interval from frame to frame, the
lag from the start of a frame to its end, and the time to submit it.
"""

import json
import sys
import time
from collections import deque
from dataclasses import astuple

import numpy as np

from ...models.machine.profile_catalog import load_hardware
from ...models.scene.extent import scene_extent
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import open_scene
from ...sim.machine.simulated_machine import FrameTimes, Submitted
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.generators.tour import tour
from ..gl.calibration import Calibration
from ..gl.context import open_target
from ..gl.draw_list import Frame, Picture
from ..gl.measures.fences import Fences
from ..gl.opengl_machine import picture_of
from ..gl.recorder import recorded_hardware
from ..gl.renderer import Renderer

_EVERY = 10  # frames of the programme, of which one is drawn
_MOST_PICTURES = 60
_MOST_IN_FLIGHT = 4
_THREADS = 1  # of llvmpipe, which else draws in the thread that submits


class _PictureKeeper:
    """A machine that draws nothing and keeps what it should have drawn, every tenth frame."""

    def __init__(self, step_ms: float) -> None:
        self._step_ms = step_ms
        self.pictures: list[Picture] = []

    def begin(self) -> None:
        """Begin a frame."""

    def run(self, frame: Submitted) -> FrameTimes:
        """Keep the picture of the frame."""
        if frame.view.frame % _EVERY == 0:
            self.pictures.append(picture_of(frame))
        return FrameTimes(0.0, 0.0, self._step_ms)


def programme(scene: Scene, size_px: tuple[int, int], frames: int) -> list[Picture]:
    """Return every tenth picture of the programme of calibration along a tour of the scene.

    There are 3 to 60, since more than are in flight have to be drawn.
    """
    frames = min(max(frames, 3 * _EVERY), _MOST_PICTURES * _EVERY)
    middle, size = scene_extent(scene)
    x, y, z = (middle - (0.0, 0.0, 0.5 * size[2])).tolist()
    path = tour((x, y, z), (float(size[0]), float(size[1])))
    keeper = _PictureKeeper(1e3 * path.duration_s / frames)
    hardware = recorded_hardware(load_hardware("llvmpipe"), size_px)
    options = ReplayOptions(budget_ms=8.0, seed=0, frames=frames)
    replay(Calibration(0), scene, path, hardware, options, name="calibration", machine=keeper)
    return keeper.pictures


def measure(
    renderer: Renderer, fences: Fences, frames: list[Frame], in_flight: int
) -> dict[str, float]:
    """Return interval, lag and time to submit in milliseconds, means over all frames drawn twice.

    Before frame k is submitted, the fence of frame k - `in_flight` is waited for.
    """
    flying: deque[tuple[int, float]] = deque()  # fences, and when their frames began
    lags_s: list[float] = []
    submits_s: list[float] = []
    renderer.context.finish()
    start = time.perf_counter()
    for k, frame in enumerate(frames * 2):
        if k >= in_flight:
            fence, began = flying.popleft()
            fences.reached(fence, wait=True)
            lags_s.append(time.perf_counter() - began)
        began = time.perf_counter()
        renderer.submit(frame, renderer.framebuffer(frame.size_px))
        flying.append((fences.set(), began))
        submits_s.append(time.perf_counter() - began)
    renderer.context.finish()
    interval_s = (time.perf_counter() - start) / (2 * len(frames))
    times_s = {"interval": interval_s, "lag": np.mean(lags_s), "cpu": np.mean(submits_s)}
    return {f"{name}_ms": 1e3 * float(value) for name, value in times_s.items()}


def main(spec: str, size: str, draws: str, count: str) -> None:
    """Measure a scene and print what was measured."""
    width, _, height = size.partition("x")
    size_px = (int(width), int(height))
    opened = open_scene(spec)
    target = open_target("egl", size_px, threads=_THREADS)
    renderer = Renderer(
        target, opened.scene, opened.read_geometry(), instancing=draws == "instanced"
    )
    frames = [renderer.prepare(picture) for picture in programme(opened.scene, size_px, int(count))]
    alone = np.median([astuple(renderer.draw(frame))[:3] for frame in frames], axis=0)
    names = ("cpu_ms", "gpu_ms", "frame_ms")
    fences = Fences(target.load)
    found: dict[str, dict[str, float]] = {"alone": dict(zip(names, alone.tolist(), strict=True))}
    for in_flight in range(1, _MOST_IN_FLIGHT + 1):
        found[str(in_flight)] = measure(renderer, fences, frames, in_flight)
    target.close()
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
