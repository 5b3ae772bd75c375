"""The bundled trace ``tour``: it meets few objects, then all at once, then goes in among them.

It stands at the edge of a box and looks along that edge, turns inward at once, so that all that is
in the box comes into view within a few frames, goes two thirds of the way through along the longer
side, and turns back.  So it has a sudden step in visible load, an approach to whatever is dense,
and a turn inside; and there is always something in view.  The turn is that of Gobbetti and Bouvier,
"Time-critical multiresolution rendering of large complex models", section 5: few objects in view,
then suddenly many.
"""

import numpy as np

from ..camera_trace import CameraTrace
from ..orientation import look_along
from .motion_paths import Timeline

EYE_M = 1.65
STAND_S = 5.0
GO_S = 25.0
WAY = 2.0 / 3.0
TURN_DEG_S = 360.0
RATE_HZ = 60.0


def tour(center_m: tuple[float, float, float], size_m: tuple[float, float]) -> CameraTrace:
    """Tour of a box on the ground, the same for the same box.

    Parameters
    ----------
    center_m
        Middle of the box; z is the ground.
    size_m
        Lengths in x and in y, > 0.
    """
    longer, axis = (size_m[0], 0) if size_m[0] >= size_m[1] else (size_m[1], 1)
    inward_deg = 90.0 * axis
    along, heading_deg = Timeline(-0.5 * longer), Timeline(inward_deg + 90.0)
    _turn(heading_deg, -90.0)
    along.hold_until(heading_deg.end_s)
    # A quarter of the time to get up to speed and a quarter to brake.
    speed_m_s = WAY * longer / (0.75 * GO_S)
    along.move_by(WAY * longer, speed_m_s, speed_m_s / (0.25 * GO_S))
    heading_deg.hold_until(along.end_s)
    _turn(heading_deg, 180.0)
    times = np.arange(round((heading_deg.end_s + STAND_S) * RATE_HZ) + 1) / RATE_HZ
    path = np.zeros((len(times), 3))
    path[:, axis] = along.at(times)
    path += (center_m[0], center_m[1], center_m[2] + EYE_M)
    orientation = look_along(np.radians(heading_deg.at(times)), np.zeros_like(times))
    return CameraTrace("tour", times, path, orientation, np.zeros(len(times), dtype=np.bool_))


def _turn(heading_deg: Timeline, change_deg: float) -> None:
    heading_deg.hold_until(heading_deg.end_s + STAND_S)
    heading_deg.move_by(change_deg, TURN_DEG_S, 20.0 * TURN_DEG_S)
