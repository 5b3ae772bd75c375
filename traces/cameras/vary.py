"""Variations of a recorded path: what the same visit might have been another time.

Where one recording is all there is, policies are tuned on its variations.  They tell how a policy
stands such a visit; of other visits they tell nothing.
"""

from dataclasses import replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import require_whole
from .camera_trace import CameraTrace
from .orientation import turn_by
from .shared_screen import SharedScreen, share, split
from .trace_stats import trace_stats

SPEED = 0.2
"""Most by which the speed differs, as a share."""

START = 0.1
"""Most by which the start differs, as a share of the path, earlier or later."""

GAZE_DEG = 4.0
"""Most by which the gaze differs, to either side; half of it up or down."""

_PERIODS_S = 2.0, 6.0  # assumed: of glances; faster ones would be tremor, slower ones another walk
_WAVES = 3
_LOWEST_HZ = 30.0  # of samples: glances stay smooth between those of a coarse recording


def vary(trace: CameraTrace, seed: int) -> CameraTrace:
    """Return a variation of a path, as long as it: other speed, other start, smooth glances.

    Where the variation comes to an end of the path, it turns and goes back.  The same path and seed
    give the same variation.

    Raises `InputError` if the seed is not a whole number of at least 0.
    """
    require_whole(seed, "seed", 0)
    if isinstance(trace, SharedScreen):
        return _vary_each(trace, seed)
    speed_rng, gaze_rng = np.random.default_rng(seed).spawn(2)
    length_s = trace.duration_s
    if length_s == 0.0:  # a path of one pose
        return trace
    factor = float(speed_rng.uniform(1.0 - SPEED, 1.0 + SPEED))
    start_s = float(speed_rng.uniform(-START, START)) * length_s
    rate_hz = max(trace_stats(trace).rate_hz, _LOWEST_HZ)
    times = np.linspace(0.0, length_s, max(2, round(length_s * rate_hz) + 1))
    at_s = _there_and_back(start_s + factor * times, length_s)
    poses = [trace.pose_at(time_s) for time_s in at_s.tolist()]
    gaze = np.array([pose.orientation_xyzw for pose in poses])
    yaw_deg, pitch_deg = (_glances(gaze_rng, times, most) for most in (GAZE_DEG, GAZE_DEG / 2.0))
    # A cut is wherever one lies between two poses, either way.
    passed = np.searchsorted(trace.time_s[trace.cut], at_s, side="right")
    return CameraTrace(
        f"{trace.name} variation {seed}",
        times,
        np.array([pose.position_m for pose in poses]),
        turn_by(gaze, np.radians(yaw_deg), np.radians(pitch_deg)),
        np.append(False, np.diff(passed) != 0),
        fovy_deg=trace.fovy_deg,
    )


def _vary_each(trace: SharedScreen, seed: int) -> CameraTrace:
    """Return a variation of every player's path, no two of which vary alike."""
    players = split(trace)
    seeds = np.random.SeedSequence(seed).generate_state(len(players)).tolist()
    varied = [vary(path, each) for path, each in zip(players, seeds, strict=True)]
    return share(replace(varied[0], name=f"{trace.name} variation {seed}"), varied[1:])


def _there_and_back(time_s: FloatArray, length_s: float) -> FloatArray:
    """Return times on a path of a length that is gone there and back, for any times, (n,)."""
    at = np.mod(time_s, 2.0 * length_s)
    return np.minimum(at, 2.0 * length_s - at)


def _glances(rng: np.random.Generator, time_s: FloatArray, most_deg: float) -> FloatArray:
    """Return angles (n,) within a bound: a few slow waves."""
    rate = 2.0 * np.pi / rng.uniform(*_PERIODS_S, _WAVES)
    phase = rng.uniform(0.0, 2.0 * np.pi, _WAVES)
    share = rng.dirichlet(np.ones(_WAVES))
    return most_deg * np.sin(np.multiply.outer(time_s, rate) + phase) @ share
