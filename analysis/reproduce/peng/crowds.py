"""One crowd seen by one camera: N for a number of triangles, and what the frame costs then."""

from typing import ClassVar

import numpy as np

from ....base.errors import InputError
from ....base.predictors import LEVEL_PREDICTORS
from ....models.machine.profile_catalog import load_hardware
from ....models.scene.scene import Scene
from ....models.scene.scene_catalog import load_scene
from ....policies.bounds.full import Full
from ....policies.budgets.peng import Peng
from ....policies.protocol import Capabilities, Policy
from ....policies.selection import Selection
from ....policies.view import View
from ....sim.frame_log import FrameLog
from ....sim.replay import ReplayOptions, replay
from ....traces.cameras.camera_trace import CameraTrace
from ....traces.cameras.orientation import look_along
from ...study.engine.task import Beat
from ..trial import Numbers

PIPELINE, INSTANCED = "quadro5000-2011", "quadro5000-instanced-assumed"
_CHARACTER_VERTICES = 1_642
_SPACING_M = 1.5
_FRAMES = 4
_BUDGET_MS = 1_000.0  # for the replay's accounts alone: N decides what is drawn
_UP_M, _BACK_M, _PITCH_DEG = 6.0, 8.0, -12.0


def camera_of(instances: int, place: str) -> CameraTrace:
    """Return a camera at rest over a square crowd: from beyond its ``corner``, or its ``edge``.

    From the corner, looking along the diagonal, all of them are in view.
    """
    half_m = _SPACING_M * (np.ceil(np.sqrt(instances)) - 1.0) / 2.0
    if place == "corner":
        along = -half_m - _BACK_M / np.sqrt(2.0)
        position, heading = (along, along, _UP_M), np.pi / 4.0
    elif place == "edge":
        position, heading = (0.0, -half_m - _BACK_M, _UP_M), np.pi / 2.0
    else:
        raise InputError(f"camera: expected corner or edge, got {place}")
    turn = look_along(heading, np.radians(_PITCH_DEG))
    return CameraTrace(
        place,
        np.array([0.0, 60.0]),
        np.tile(position, (2, 1)),
        np.tile(turn, (2, 1)),
        np.zeros(2, dtype=np.bool_),
    )


def with_triangles(*, instances: int, triangles: int, beat: Beat) -> Numbers:
    """Return the crowd at the N, in vertices, that leads to so many triangles; and instanced."""
    scene = load_scene(f"crowd-{instances}")
    camera = camera_of(instances, "corner")
    vertices = _search_vertices(scene, camera, triangles, beat)
    log = _draw(scene, camera, vertices, frames=_FRAMES)
    instanced = _replay(Full(), scene, camera, INSTANCED, _FRAMES)
    return {
        "vertices": vertices,
        "triangles": _triangles(log),
        "in_view": float(log["drawn"][-1]),
        "frame_ms": float(log["gpu_ms"].mean()),
        # Every frame is made anew, so that a camera at rest is no cheaper than one that moves.
        "first_ms": float(log["gpu_ms"][0]),
        "last_ms": float(log["gpu_ms"][-1]),
        "instanced_ms": float(instanced["gpu_ms"].mean()),
    }


def with_coarsest(*, instances: int, place: str, beat: Beat) -> Numbers:
    """Return the triangles of a crowd at the N that has its smallest character at the coarsest.

    "We set such N that guarantees no over-simplification on the farthest characters."
    """
    scene, camera = load_scene(f"crowd-{instances}"), camera_of(instances, place)
    beat(0)
    watching = _Watching()
    _replay(watching, scene, camera, PIPELINE, 1)
    root = np.cbrt(watching.area_px)
    coarsest = float(scene.types.levels.counts[-1, LEVEL_PREDICTORS.index("vertices")])
    # Equation 1, solved for N where the smallest share is the coarsest level's vertices.
    vertices = round(coarsest * float(root.sum()) / float(root.min()))
    log = _draw(scene, camera, vertices)
    return {"vertices": vertices, "triangles": _triangles(log), "in_view": float(len(root))}


class _Watching:
    """Draws everything in full, and remembers the areas of what is in view."""

    capabilities: ClassVar[Capabilities] = Full.capabilities

    def __init__(self) -> None:
        self._full, self.area_px = Full(), np.zeros(0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self._full.reset(scene, budget_ms)

    def select(self, view: View) -> Selection:
        """Return everything."""
        self.area_px = view.area_px.copy()
        return self._full.select(view)


def _search_vertices(scene: Scene, camera: CameraTrace, wanted: float, beat: Beat) -> int:
    """Return the least N that leads to so many triangles."""
    low, high, step = 1, 64 * _CHARACTER_VERTICES * len(scene), 0
    while low < high:
        beat(step)
        step += 1
        middle = (low + high) // 2
        enough = _triangles(_draw(scene, camera, middle)) >= wanted
        low, high = (low, middle) if enough else (middle + 1, high)
    return low


def _draw(scene: Scene, camera: CameraTrace, vertices: int, frames: int = 1) -> FrameLog:
    return _replay(Peng(vertices=vertices), scene, camera, PIPELINE, frames)


def _replay(
    policy: Policy, scene: Scene, camera: CameraTrace, machine: str, frames: int
) -> FrameLog:
    options = ReplayOptions(budget_ms=_BUDGET_MS, frames=frames)
    return replay(policy, scene, camera, load_hardware(machine), options, name="peng")


def _triangles(log: FrameLog) -> float:
    return float(log["triangles"][-1])
