"""Where instances are drawn: placements relative to the eye, bones, and the projection."""

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from .shaders import BONES

_STEP_HZ, _SWING_RAD = 1.0, 0.12


def placements(
    scene: Scene, ids: IntArray, centers_m: FloatArray, camera: Camera
) -> NDArray[np.float32]:
    """Return translation relative to the eye, scale and quaternion of nodes, (n, 8)."""
    moved = centers_m.take(ids, axis=1).T - scene.center_m[ids]
    out = np.empty((len(ids), 8), dtype=np.float32)
    out[:, :3] = scene.position_m[ids] + moved - np.array(camera.position_m)
    out[:, 3] = scene.scale[ids]
    out[:, 4:] = scene.orientation_xyzw[ids]
    return out


def bone_palette(ids: IntArray, time_s: float) -> NDArray[np.float32]:
    """Return the bones of skinned nodes as rows of 3 x 4 matrices, (n, BONES, 3, 4).

    Bone k shears the body sideways by its height, in the rhythm of a step; nodes are out of step.
    """
    phase = 2.0 * np.pi * (_STEP_HZ * time_s + (ids * 0.618034) % 1.0)
    bend = _SWING_RAD * np.sin(phase[:, None] + np.linspace(0.0, np.pi, BONES))
    out = np.zeros((len(ids), BONES, 3, 4), dtype=np.float32)
    out[:, :, 0, 0] = out[:, :, 1, 1] = out[:, :, 2, 2] = 1.0
    out[:, :, 0, 2] = bend
    return out


def projection(camera: Camera, far_m: float) -> NDArray[np.float32]:
    """Return the matrix from the scene's directions about the eye to clip space, column-major."""
    near = camera.near_m
    lens = np.zeros((4, 4))
    lens[0, 0] = 2.0 * camera.focal_px / camera.width_px
    lens[1, 1] = 2.0 * camera.focal_px / camera.height_px
    lens[2, 2], lens[2, 3] = (far_m + near) / (far_m - near), -2.0 * far_m * near / (far_m - near)
    lens[3, 2] = 1.0
    turn = np.eye(4)
    turn[:3, :3] = camera.axes  # right, up, forward
    return np.ascontiguousarray((lens @ turn).T, dtype=np.float32)


def farthest_m(scene: Scene, camera: Camera, centers_m: FloatArray) -> float:
    """Return a far plane behind everything."""
    gap = centers_m - np.array(camera.position_m)[:, None]
    reach = np.sqrt(np.einsum("ij,ij->j", gap, gap)) + scene.radius_m
    return max(float(reach.max()), 10.0 * camera.near_m)
