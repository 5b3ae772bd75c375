"""Two scenes that machines are calibrated on beside ``plaza``, so that costs are told apart.

``calibration-near`` has 280 walls, boards, pylons and crags of 132 to 320 triangles, 6 to 12 m
tall and close together: what is drawn fills the picture, and pixels are what takes time.

``calibration-dense`` has 96 objects of six unlike shapes of 5,120 to 56,960 triangles, 1.5 to 3 m
tall, in seven levels: nearly all triangles are smaller than a pixel, and they are what takes time.

Both are flat and stand still.  What was calibrated on them is validated on others.
"""

from collections.abc import Callable, Sequence

import numpy as np

from ..layouts.placement import place
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.simplify import ChainOptions, build_chain
from ..meshes.surface_mesh import SurfaceMesh
from ..scene.scene import Scene
from .parts.calibration_meshes import (
    board_mesh,
    coral_mesh,
    crag_mesh,
    hill_mesh,
    knot_mesh,
    pebble_mesh,
    pylon_mesh,
    ring_mesh,
    urn_mesh,
    wall_mesh,
)
from .scene_registry import BundledScene

_SAMPLING = Sampling(vertices=1_500, surface=500)


def build_calibration_near() -> tuple[Scene, Geometry]:
    """Return 280 large objects of few triangles, scattered over 256 m by 256 m."""
    makers = (wall_mesh, board_mesh, pylon_mesh, crag_mesh)
    chain = ChainOptions(levels=4, ratio=0.5, min_triangles=12)
    return _scattered("calibration-near", 1501, makers, chain, count=280, side_m=256.0)


def build_calibration_dense() -> tuple[Scene, Geometry]:
    """Return 96 objects of dense meshes, scattered over 60 m by 60 m."""
    makers = (pebble_mesh, ring_mesh, urn_mesh, hill_mesh, knot_mesh, coral_mesh)
    chain = ChainOptions(levels=7, ratio=0.48, min_triangles=48)
    return _scattered("calibration-dense", 1502, makers, chain, count=96, side_m=60.0)


def _scattered(
    name: str,
    seed: int,
    makers: Sequence[Callable[[np.random.Generator], SurfaceMesh]],
    chain: ChainOptions,
    *,
    count: int,
    side_m: float,
) -> tuple[Scene, Geometry]:
    """Return a scene of equal numbers of each mesh, of scales from 0.8 to 1.2."""
    shape_rng, place_rng = np.random.default_rng(seed).spawn(2)
    models = [build_chain(make(shape_rng), chain, _SAMPLING) for make in makers]
    kind = np.arange(count, dtype=np.int32) % len(models)
    scale = place_rng.uniform(0.8, 1.2, count)
    radius_m = scale * np.array([model.radius_m for model in models])[kind]
    plan = place("scatter", radius_m, place_rng, side_m=side_m)
    yaw = place_rng.uniform(-np.pi, np.pi, count)
    return scene_of_objects(name, models, kind, plan, yaw, scale)


CALIBRATION_NEAR = BundledScene(
    "280 large objects of 132 to 320 triangles, to calibrate costs of pixels",
    build_calibration_near,
)
CALIBRATION_DENSE = BundledScene(
    "96 objects of 5,120 to 56,960 triangles, to calibrate costs of small triangles",
    build_calibration_dense,
)
