"""A way through given points at a constant speed: along corridors and streets."""

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..orientation import look_along

_STEP_M = 0.05
_RATE_HZ = 60.0
_LOOK_S = 0.6  # time that a turn of the head takes at least


def follow_route(
    name: str,
    points_m: FloatArray,
    *,
    speed_m_s: float,
    height_m: float,
    duration_s: float,
    bend_m: float = 1.5,
    start: float = 0.0,
) -> CameraTrace:
    """Trace along a polyline that looks where it goes; the same points at any speed.

    A closed polyline is gone round, another one there and back.

    Raises `InputError` if there are fewer than two distinct points, or a number is not above 0.

    Parameters
    ----------
    points_m
        (n, 2) with n >= 2, or (n, 3) with the ground's z; the last may equal the first.
    height_m
        Above the points.
    bend_m
        Length over which corners are rounded, > 0.
    start
        Where on the round, or on the way there and back, to begin, in [0, 1).
    """
    if not min(speed_m_s, duration_s, bend_m) > 0.0:
        raise InputError(
            "route: expected speed, duration and bend above 0, got "
            f"{speed_m_s}, {duration_s} and {bend_m}"
        )
    line = _rounded(points_m, bend_m)
    closed = bool(np.allclose(line[0], line[-1]))
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    times = np.arange(round(duration_s * _RATE_HZ) + 1) / _RATE_HZ
    whole = float(along[-1]) if closed else 2.0 * float(along[-1])
    gone = start * whole + speed_m_s * times
    at = np.mod(gone, along[-1])
    forth = np.ones(len(times), dtype=np.bool_)
    if not closed:
        forth = np.mod(gone, whole) < along[-1]
        at = np.where(forth, at, along[-1] - at)
    position = np.stack([np.interp(at, along, line[:, i]) for i in range(3)], axis=1)
    position[:, 2] += height_m
    heading = _headings(line, along, at, forth)
    level = np.zeros(len(times))
    cut = np.zeros(len(times), dtype=np.bool_)
    return CameraTrace(name, times, position, look_along(heading, level), cut)


def _rounded(points_m: FloatArray, bend_m: float) -> FloatArray:
    """Return points (m, 3) a few centimetres apart, averaged over the bend; the ends stay."""
    points = np.column_stack((points_m, np.zeros((len(points_m), 3 - points_m.shape[1]))))
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.append(0.0, np.cumsum(length))
    whole = float(along[-1])
    if not whole > bend_m:
        raise InputError(f"route: expected a way longer than {bend_m:g} m, got {whole:g} m")
    fine = np.linspace(0.0, whole, int(whole / _STEP_M) + 2)
    line = np.stack([np.interp(fine, along, points[:, i]) for i in range(3)], axis=1)
    half = max(1, round(bend_m / _STEP_M / 2.0))
    sums = np.cumsum(np.vstack((np.zeros((1, 3)), line)), axis=0)
    row = np.arange(len(line))
    # Windows shrink towards the ends, so that these stay where they are.
    reach = np.minimum(half, np.minimum(row, len(line) - 1 - row))
    width = (2 * reach + 1)[:, None]
    smooth: FloatArray = (sums[row + reach + 1] - sums[row - reach]) / width
    return smooth


def _headings(line: FloatArray, along: FloatArray, at: FloatArray, forth: BoolArray) -> FloatArray:
    """Return where the camera looks: ahead, averaged over the time of a look, (n,)."""
    tangent = np.gradient(line[:, :2], along, axis=0)
    ahead = np.stack([np.interp(at, along, tangent[:, i]) for i in range(2)], axis=1)
    ahead = np.where(forth[:, None], ahead, -ahead)
    heading = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    half = round(_LOOK_S * _RATE_HZ / 2.0)
    padded = np.concatenate((np.full(half, heading[0]), heading, np.full(half, heading[-1])))
    window = np.full(2 * half + 1, 1.0 / (2 * half + 1))
    return np.convolve(padded, window, mode="valid")
