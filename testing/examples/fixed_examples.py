"""Fixed examples: walks past small scenes on machines that take a frame a refresh.

A walk shows each of its poses for one refresh of the screen.  Frames that finish within a refresh
begin in the same order under every policy, so that all policies see the same poses.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from ...models.machine.cost import CostModel, CpuCostModel
from ...models.machine.hardware import Display, DisplayMode, HardwareProfile, Provenance
from ...models.scene.benefit import level_primitives
from ...models.scene.scene import Scene
from ...policies.protocol import Capabilities, Policy, why_not_applicable
from ...policies.selection import Selection
from ...policies.view import View
from ...traces.cameras.camera_trace import CameraTrace, Pose
from ...traces.cameras.orientation import look_along
from .example import Example
from .small_scenes import lone_object, small_scenes

TIGHT, PLENTY = 0.4, 2.0
"""Budgets by the share of the way from the coarsest selection to full detail."""
NEXT_TO_NOTHING = -math.inf
"""Stands for a budget of a nanosecond."""

_LINEAR = {
    "draw_calls": 2e-3,
    "triangles": 1e-4,
    "shaded_samples": 1e-6,
    "framebuffer_pixels": 1e-7,
    "state_changes": 5e-3,
}
_ROOFLINE = {"triangles": 1e-4, "shaded_samples": 1e-5}
_PLAIN = CostModel.of(0.2, _LINEAR)
_BENT = CostModel.of(0.2, _LINEAR | {"vertices": 5e-5}, _ROOFLINE)
_COSTS = (_PLAIN, _PLAIN, _BENT, _PLAIN, _BENT)
_IN_FLIGHT = 2
_LEAD = _IN_FLIGHT + 1  # frames that begin at once, before the screen sets the pace


def pose_at(along_m: float, *, turned_deg: float = 0.0) -> Pose:
    """Return a level pose on the scenes' axis, looking along +y or turned to the left."""
    turn = look_along(math.radians(90.0 + turned_deg), 0.0).tolist()
    return Pose((0.0, along_m, 0.0), tuple(turn))


SIGHT, AWAY = pose_at(2.0), pose_at(-20.0, turned_deg=180.0)

WALK = (
    *(pose_at(0.3 * k, turned_deg=2.0 * k) for k in range(6)),
    *(pose_at(40.0 - 0.2 * k, turned_deg=170.0) for k in range(4)),  # a cut
    *(pose_at(12.0 + k) for k in range(3)),
)
"""Poses of a walk with two cuts."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A scene and what its frames cost."""

    scene: Scene
    costs: CostModel


@cache
def places() -> tuple[Place, ...]:
    """Return where the fixed examples are, one place for each kind of scene."""
    return tuple(Place(*pair) for pair in zip(small_scenes(), _COSTS, strict=True))


@cache
def _lone_places() -> dict[Place, Place]:
    return {place: Place(lone_object(place.scene), place.costs) for place in places()}


def fitting(capabilities: Capabilities, *, lone: bool = False) -> Iterator[Place]:
    """Yield the places that a policy can drive, reduced to one object each if `lone`."""
    for place in places():
        if why_not_applicable(capabilities, place.scene) is None:
            yield _lone_places()[place] if lone else place


@cache
def example_at(
    place: Place,
    share: float,
    poses: tuple[Pose, ...] = WALK,
    *,
    mode: DisplayMode = "vsync",
    refresh_hz: float = 60.0,
    frames: int = 0,
    memory_share: float | None = None,
) -> Example:
    """Return the example of a walk past a place; one object for one set of arguments.

    Parameters
    ----------
    share
        Budget between the least time of the last pose and that of full detail, from 0 to 1.
    frames
        0 for as many as the walk has poses.
    memory_share
        How much of the nodes other than the roots fits in memory; None for all.
    """
    display = Display(
        mode, refresh_hz, refresh_hz, images=2, latency_limit=0, width_px=640, height_px=360
    )
    machine = HardwareProfile(
        "fixed",
        Provenance("assumed: made up for a test", assumed=True),
        place.costs,
        CpuCostModel.of(0.1, {}),
        display=display,
        frames_in_flight=_IN_FLIGHT,
    )
    if memory_share is not None:
        machine = replace(machine, memory_bytes=_memory_bytes(place.scene, memory_share))
    budget_ms = 1e-6
    if share != NEXT_TO_NOTHING:
        least_ms, full_ms = _span_ms(place, poses[0] if poses == WALK else SIGHT)
        budget_ms = max(budget_ms, least_ms + share * (full_ms - least_ms))
    count = frames or len(poses) + _LEAD
    return Example(place.scene, _walk(poses, 1.0 / refresh_hz), machine, budget_ms, count)


def _walk(poses: tuple[Pose, ...], step_s: float) -> CameraTrace:
    """Return a trace that is cut from pose to pose, the first held while the queue fills."""
    time_s = np.arange(len(poses), dtype=np.float64)
    time_s[1:] += 1.0
    return CameraTrace(
        "walk",
        step_s * time_s,
        np.array([pose.position_m for pose in poses]),
        np.array([pose.orientation_xyzw for pose in poses]),
        np.arange(len(poses)) > 0,
    )


def _memory_bytes(scene: Scene, share: float) -> float:
    levels = scene.types.levels
    node_bytes = np.add.reduceat(levels.bytes, levels.start[:-1])[scene.type_index]
    roots = float(np.ceil(node_bytes[scene.roots]).sum())
    return roots + share * (float(np.ceil(node_bytes).sum()) - roots)


@cache
def _span_ms(place: Place, pose: Pose) -> tuple[float, float]:
    """Return the time of a pose at its coarsest and in full detail."""
    log = example_at(place, NEXT_TO_NOTHING, (pose,), frames=1).play(_Coarsest()).log
    return float(log["model_gpu_ms"][0]), float(log["full_gpu_ms"][0])


class _Coarsest(Policy):
    """Draws the least there is to draw."""

    capabilities = Capabilities(continuous=True, hierarchy=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Keep nothing."""

    def select(self, view: View) -> Selection:
        """Return the coarsest selection."""
        return coarsest(view)


def coarsest(view: View) -> Selection:
    """Return the least that a view can be drawn with: roots, or what an empty root stands above."""
    scene = view.scene
    levels = scene.types.levels
    empty = level_primitives(levels)[levels.start[:-1]][scene.type_index] == 0.0
    empty &= np.diff(scene.child_start) > 0
    front = view.ids
    while empty[front].any():
        below = [scene.children(node) for node in front[empty[front]].tolist()]
        front = np.concatenate((front[~empty[front]], *below)).astype(np.int32)
    front = front[view.state.inside[front]]
    kind = scene.type_index[front]
    coarse = np.where(
        levels.continuous[kind], levels.min_resolution[kind], levels.level_count[kind] - 1.0
    )
    return Selection(front, coarse)
