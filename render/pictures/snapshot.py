"""One frame of a replay: the camera, and what a policy draws in it."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.camera import Camera
from ...models.scene.motion import Centers
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.protocol import why_not_applicable
from ...policies.shared.observer import watch
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What is drawn in a frame.

    Attributes
    ----------
    camera : Camera
    ids : (m,) int32
        Nodes drawn, those outside the frustum left out.
    detail : (m,) float64
        As in `Selection`.
    centers_m : (3, N) float64
        Centres of all nodes in that frame.
    """

    scene: Scene
    label: str
    frame: int
    camera: Camera
    ids: IntArray
    detail: FloatArray
    centers_m: FloatArray


def take_snapshot(
    spec: PolicySpec,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    frame: int,
) -> Snapshot:
    """Replay up to a frame and return what the policy draws in it.

    After its end a trace stays where it is.

    Raises
    ------
    InputError
        If the policy does not apply to the scene.
    PolicyError
        If the policy breaks its contract.
    """
    policy = spec.make()
    reason = why_not_applicable(policy.capabilities, scene)
    if reason is not None:
        raise InputError(f"{spec.label}: expected a policy that fits the scene; {reason}")
    watched = watch(policy)
    replay(watched, scene, trace, hardware, replace(options, frames=frame + 1), name=spec.label)
    view, selection = watched.last
    assert view is not None
    assert selection is not None
    keep = view.state.inside[selection.ids]
    return Snapshot(
        scene,
        spec.label,
        frame,
        view.camera,
        selection.ids[keep],
        selection.detail[keep],
        view.state.centers_m,
    )


def recorded_snapshot(
    scene: Scene, log: FrameLog, frame: int, size_px: tuple[int, int], fovy_deg: float
) -> Snapshot:
    """Return what a replay drew in a frame of which its log keeps the levels.

    A continuous node has the resolution of the knot that it has passed, as `LevelHistory` has it.

    Parameters
    ----------
    size_px : (width, height)
        Of the picture, which may be smaller than the replay's.
    """
    levels = log.levels
    assert levels is not None
    level = levels.at(frame, len(scene))
    ids = np.flatnonzero(level >= 0).astype(np.int32)
    table, drawn = scene.types.levels, level[ids].astype(np.float64)
    kind = scene.type_index[ids]
    soft = table.continuous[kind]
    detail = np.where(soft, table.resolution[scene.finest_row[ids] + level[ids]], drawn)
    x, y, z = (float(log[axis][frame]) for axis in ("x_m", "y_m", "z_m"))
    qx, qy, qz, qw = levels.turn_xyzw[frame].tolist()
    camera = Camera((x, y, z), (qx, qy, qz, qw), *size_px, math.radians(fovy_deg))
    centers = Centers(scene.center_m, scene.motion).at(1e-9 * float(log["input_ns"][frame]))
    return Snapshot(scene, log.header.policy, frame, camera, ids, detail, centers.all_m)
