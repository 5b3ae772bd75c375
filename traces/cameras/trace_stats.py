"""What a camera trace is like: length, rate, speeds, turn rates, gaps, cuts and repairs."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from .camera_trace import CameraTrace
from .orientation import turn_deg

# An interval longer than this many median intervals is a gap.
GAP_FACTOR = 5.0


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Percentiles over the intervals between samples; 0 where there is no interval."""

    p5: float
    p50: float
    p95: float
    max: float


@dataclass(frozen=True, slots=True)
class TraceStats:
    """Summary of a trace.

    ``rate_hz`` is 1 / median interval (0 for one sample); speeds, turn rates and ``path_m`` leave
    out the jumps of cuts; ``gaps`` counts intervals over 5 medians.
    """

    samples: int
    duration_s: float
    rate_hz: float
    path_m: float
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    speed_m_s: Percentiles
    turn_deg_s: Percentiles
    gaps: int
    longest_gap_s: float
    cuts: int
    repairs: tuple[str, ...]


def trace_stats(trace: CameraTrace) -> TraceStats:
    """Summary of a trace from its samples."""
    interval_s = np.diff(trace.time_s)
    median_s = float(np.median(interval_s)) if interval_s.size else 0.0
    gap_s = interval_s[interval_s > GAP_FACTOR * median_s]
    smooth = ~trace.cut[1:]
    step_m = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1)[smooth]
    turned_deg = turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:])[smooth]
    x0, y0, z0 = trace.position_m.min(axis=0).tolist()
    x1, y1, z1 = trace.position_m.max(axis=0).tolist()
    return TraceStats(
        samples=len(trace),
        duration_s=trace.duration_s,
        rate_hz=1.0 / median_s if median_s else 0.0,
        path_m=float(step_m.sum()),
        low_m=(x0, y0, z0),
        high_m=(x1, y1, z1),
        speed_m_s=_percentiles(step_m / interval_s[smooth]),
        turn_deg_s=_percentiles(turned_deg / interval_s[smooth]),
        gaps=int(gap_s.size),
        longest_gap_s=float(gap_s.max(initial=0.0)),
        cuts=int(trace.cut.sum()),
        repairs=tuple(map(str, trace.repairs)),
    )


def _percentiles(values: FloatArray) -> Percentiles:
    if not values.size:
        return Percentiles(0.0, 0.0, 0.0, 0.0)
    p5, p50, p95, largest = np.percentile(values, [5, 50, 95, 100]).tolist()
    return Percentiles(p5, p50, p95, largest)
