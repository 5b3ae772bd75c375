"""Whether a trace can be what it says: speeds, heights and turns that no camera has.

A wrong guess of a unit or an axis shows in these; a person then looks at one line.
"""

import numpy as np

from .camera_trace import CameraTrace
from .orientation import view_direction
from .trace_stats import trace_stats

SPEED_M_S = 0.05, 60.0
TURN_DEG_S = 1000.0
_STEEP = 0.5  # vertical share of the mean view direction
_GAPS = 0.05  # share of intervals


def sanity_line(trace: CameraTrace) -> str:
    """Return what a trace implies, to be read by who knows how it was recorded."""
    stats = trace_stats(trace)
    low, high = stats.low_m[2], stats.high_m[2]
    return (
        f"median speed {stats.speed_m_s.p50:.3g} m/s, height {low:.3g} to {high:.3g} m, "
        f"turns {stats.turn_deg_s.p50:.3g} degrees a second, at most {stats.turn_deg_s.max:.3g}"
    )


def doubts(trace: CameraTrace) -> tuple[str, ...]:
    """Return what of a trace can hardly be, each with what to look at."""
    stats = trace_stats(trace)
    found: list[str] = []
    speed = stats.speed_m_s.p50
    if stats.path_m > 0.0 and speed > SPEED_M_S[1]:
        found.append(f"a median speed of {speed:.3g} m/s: is the unit of lengths or times another?")
    elif 0.0 < speed < SPEED_M_S[0] and stats.speed_m_s.p95 < SPEED_M_S[0]:
        found.append(f"a median speed of {speed:.2g} m/s: is the unit of lengths or times another?")
    if stats.turn_deg_s.max > TURN_DEG_S:
        found.append(
            f"a turn of {stats.turn_deg_s.max:,.0f} degrees a second: are times or turns wrong?"
        )
    if stats.gaps > _GAPS * max(1, stats.samples - 1):
        found.append(f"{stats.gaps} gaps: is it several recordings, or a clock that stalls?")
    up = float(np.mean(view_direction(trace.orientation_xyzw)[:, 2]))
    if abs(up) > _STEEP:
        way = "up" if up > 0.0 else "down"
        found.append(f"a view that is mostly {way}: is another axis up, or is it the inverse?")
    return tuple(found)
