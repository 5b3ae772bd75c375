"""A fixed frame, drawn before and after each measured one: how fast the machine is at the moment.

It is the same for every scene, policy and size of picture, so that what its time does is the
machine's doing: clock rates, heat, and what else runs there.  Eight lumps of 320 triangles fill
a picture of 160 by 90 px, which takes a software rasteriser about as long in triangles as in
pixels.
"""

import time
from collections.abc import Callable

import numpy as np

from ....models.layouts.scene_builder import scene_of_objects
from ....models.meshes.geometry import Geometry
from ....models.meshes.mesh_error import Sampling
from ....models.meshes.shapes import lump
from ....models.meshes.surface_mesh import clean_surface
from ....models.meshes.type_model import measure_levels
from ....models.scene.camera import Camera
from ....models.scene.scene import Scene
from ..context import Target
from ..draw_list import Picture
from ..renderer import Renderer

_REPEATS = 3
_WARMUP = 5
_SIZE_PX = (160, 90)
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)  # looks along -z
_FOVY_RAD = np.pi / 3.0
_ROW, _ROWS, _APART_M = 4, 2, 1.6


class ReferenceDraw:
    """Draws the frame, and returns what it takes by the clock of the others."""

    def __init__(self, target: Target, clock: Callable[[], int] = time.perf_counter_ns) -> None:
        scene, geometry = _lumps()
        self._renderer = Renderer(target, scene, geometry, instancing=False, clock=clock)
        self._frame = self._renderer.prepare(_picture(scene))
        for _ in range(_WARMUP):
            self._renderer.draw(self._frame)

    def take_ms(self) -> float:
        """Draw it three times; return the median."""
        drawn = [self._renderer.draw(self._frame).frame_ms for _ in range(_REPEATS)]
        return sorted(drawn)[_REPEATS // 2]


def _lumps() -> tuple[Scene, Geometry]:
    rng = np.random.default_rng(1)
    surface = clean_surface("lump", [lump(rng, 2, 0.2)])
    model = measure_levels([surface], Sampling(100, 100))
    count = _ROW * _ROWS
    plan_m = np.array([(i % _ROW - 1.5, i // _ROW - 0.5) for i in range(count)]) * _APART_M
    kind, one = np.zeros(count, dtype=np.int32), np.ones(count)
    return scene_of_objects("reference", [model], kind, plan_m, rng.uniform(0.0, 6.0, count), one)


def _picture(scene: Scene) -> Picture:
    """Return all lumps from above, so that they just fill the picture."""
    camera = Camera((0.0, 0.0, 4.5), _UPRIGHT, *_SIZE_PX, _FOVY_RAD)
    ids = np.arange(len(scene), dtype=np.int32)
    distance_m = np.linalg.norm(scene.center_m - np.array(camera.position_m), axis=1)
    row = np.zeros(len(scene), dtype=np.int64)
    return Picture(camera, scene.center_m.T, ids, row, distance_m, 0.0, _SIZE_PX)
