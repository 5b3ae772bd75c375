"""A peer that any machine has: plain numpy that culls and projects, timed in the same run."""

import math
import statistics
import time
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene


def cull_plainly(scene: Scene, camera: Camera) -> int:
    """Return how many spheres are in view, with their distances and areas, as one writes it first.

    All in float64, one array after the other: no levels, costs, buffers or BLAS.
    """
    offset = scene.center_m - np.array(camera.position_m)
    x, y, z = np.einsum("ij,nj->in", camera.axes, offset)
    distance = np.sqrt(x**2 + y**2 + z**2)
    radius = scene.radius_m
    inside = z > camera.near_m - radius
    for side, pixels in ((x, camera.width_px), (y, camera.height_px)):
        half = math.atan(0.5 * pixels / camera.focal_px)
        inside &= z * math.sin(half) - side * math.cos(half) >= -radius
        inside &= z * math.sin(half) + side * math.cos(half) >= -radius
    gap = np.maximum(z**2 - radius**2, 1e-30)
    area = np.pi * (camera.focal_px * radius) ** 2 / gap
    area = area * np.sqrt(np.maximum(distance**2 - radius**2, 0.0) / gap)
    area = np.where(z - radius < camera.near_m, camera.viewport_px, area)
    ids = np.flatnonzero(inside)
    seen = np.stack((ids, distance[ids], np.minimum(area, camera.viewport_px)[ids]))
    return seen.shape[1]


@pytest.fixture(scope="session")
def plain_ms() -> Callable[[Scene, Camera], float]:
    """Return a function that times the peer on all nodes of a scene: the median of 21 passes.

    In processor time, as what is compared with it, so that other work on the machine counts little.
    """

    def measure(scene: Scene, camera: Camera) -> float:
        took_ms: list[float] = []
        for _ in range(21):
            start = time.process_time()
            cull_plainly(scene, camera)
            took_ms.append(1e3 * (time.process_time() - start))
        return statistics.median(took_ms)

    return measure
