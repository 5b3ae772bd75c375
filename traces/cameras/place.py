"""Place a camera trace into a scene: turn, scale and move it. Times never change.

A scale multiplies distances and therefore speeds; turn rates and the cuts stay as they are.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .camera_trace import CameraTrace

# Euler angles (degrees, about x then y) of the rotation that turns each axis up to +z.
UP_AXES = {
    "z": (0.0, 0.0),
    "y": (90.0, 0.0),
    "x": (0.0, -90.0),
    "-z": (180.0, 0.0),
    "-y": (-90.0, 0.0),
    "-x": (0.0, 90.0),
}


@dataclass(frozen=True, slots=True)
class Placement:
    """How a trace is put into a scene, in this order: up axis, yaw, scale, offset.

    Parameters
    ----------
    scale
        Factor on positions, > 0.
    offset_m
        Added after turning and scaling.
    up
        The axis that points up in the trace as it was read. Every reader already turns its
        format's own up axis to z, so anything else is for files that break their format's rule.
    yaw_deg
        Turn about the up axis, counter-clockwise seen from above.
    """

    scale: float = 1.0
    offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: str = "z"
    yaw_deg: float = 0.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.scale) and self.scale > 0.0):
            raise InputError(f"expected a scale above 0, got {self.scale}; give a factor")
        if not np.all(np.isfinite((*self.offset_m, self.yaw_deg))):
            raise InputError(
                f"expected a finite offset and yaw, got {self.offset_m} and {self.yaw_deg}; "
                "give metres and degrees"
            )
        if self.up not in UP_AXES:
            raise InputError(
                f"expected an up axis out of {', '.join(UP_AXES)}, got {self.up!r}; name one"
            )


def place(trace: CameraTrace, placement: Placement) -> CameraTrace:
    """Trace turned, scaled and moved as the placement says."""
    position, orientation = trace.position_m, trace.orientation_xyzw
    if placement.up != "z" or placement.yaw_deg != 0.0:
        position, orientation = _turn(trace, placement)
    position = position * placement.scale + np.array(placement.offset_m)
    return replace(trace, position_m=position, orientation_xyzw=orientation)


def _turn(trace: CameraTrace, placement: Placement) -> tuple[FloatArray, FloatArray]:
    from scipy.spatial.transform import Rotation

    about_x, about_y = UP_AXES[placement.up]
    turn = Rotation.from_euler("xyz", [about_x, about_y, placement.yaw_deg], degrees=True)
    orientation: FloatArray = (turn * Rotation.from_quat(trace.orientation_xyzw)).as_quat()
    return trace.position_m @ turn.as_matrix().T, orientation


def fit_placement(
    trace: CameraTrace,
    *,
    center_m: tuple[float, float, float],
    extent_m: tuple[float, float],
    eye_height_m: float,
) -> Placement:
    """Placement that fits the horizontal extent of a trace into a scene.

    The box around the path gets its middle above ``center_m``, and the largest uniform scale
    at which it is no longer than ``extent_m`` in x and in y. Its lowest sample comes to
    ``eye_height_m`` above ``center_m``, so that the camera never goes below the ground. A path
    that stands still keeps scale 1.

    Raises `InputError` if the extent is not positive, or anything is not finite.
    """
    if not (min(extent_m) > 0.0 and np.all(np.isfinite(extent_m))):
        raise InputError(f"expected an extent above 0 m in x and y, got {extent_m}; give lengths")
    low, high = trace.position_m.min(axis=0), trace.position_m.max(axis=0)
    moved = high[:2] - low[:2] > 1e-6
    scale = float(np.min(np.array(extent_m)[moved] / (high - low)[:2][moved], initial=np.inf))
    scale = scale if np.isfinite(scale) else 1.0
    x, y = np.array(center_m[:2]) - scale * 0.5 * (low + high)[:2]
    z = center_m[2] + eye_height_m - scale * low[2]
    return Placement(scale=scale, offset_m=(float(x), float(y), float(z)))
