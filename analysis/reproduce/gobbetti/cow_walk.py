"""The camera's way through the cows: all of them, few, suddenly many, and all again."""

import numpy as np

from ....traces.cameras.camera_trace import CameraTrace
from ....traces.cameras.orientation import look_along

_RATE_HZ = 60.0
_SIDE_M = 200.0
_BEFORE_M, _HEIGHT_M, _EYE_M = 70.0, 25.0, 1.7
_TO = 0.75  # of the way from the middle to the far edge, so that few cows are left ahead
_IN_S, _STAY_S, _TURN_S, _LOOK_S, _OUT_S = 15.0, 1.0, 0.15, 2.0, 6.0

WALK_S = _IN_S + _STAY_S + _TURN_S + _LOOK_S + _OUT_S


def cow_walk(seed: int) -> CameraTrace:
    """Return the way: from before the field across it, about at its far edge, and out backwards.

    Seeds go on lanes of their own.
    """
    lane_m = float(np.random.default_rng(seed).uniform(-0.25, 0.25)) * _SIDE_M
    edge_m = 0.5 * _SIDE_M
    clock = np.cumsum([0.0, _IN_S, _STAY_S, _TURN_S, _LOOK_S, _OUT_S])
    far_m = edge_m + _BEFORE_M
    x = [-far_m, *[_TO * edge_m] * 4, far_m]
    z = [_HEIGHT_M, *[_EYE_M] * 4, _HEIGHT_M]
    heading = [0.0, 0.0, 0.0, np.pi, np.pi, np.pi]
    down = float(np.arctan2(_HEIGHT_M, far_m))
    pitch = [-down, 0.0, 0.0, 0.0, 0.0, -down]
    time_s = np.arange(round(WALK_S * _RATE_HZ) + 1) / _RATE_HZ
    at = [np.interp(time_s, clock, values) for values in (x, z, heading, pitch)]
    position = np.column_stack((at[0], np.full(len(time_s), lane_m), at[1]))
    none = np.zeros(len(time_s), dtype=np.bool_)
    return CameraTrace(f"cow-walk-{seed}", time_s, position, look_along(at[2], at[3]), none)
