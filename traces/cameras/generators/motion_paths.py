"""Two ways to move without a jerk: round a closed curve, and in legs with bounded acceleration."""

from dataclasses import dataclass, field

import numpy as np

from ....base.arrays import FloatArray

CURVE_POINTS = 4096
# Terms of the Fourier series; more make the curve wind more.
CURVE_TERMS = 3
CANDIDATES = 32
# Seconds between the points of a timeline, and most points of a leg.
GRAIN_S = 0.01
LEG_POINTS = 10_000


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of a movement: speed, acceleration along and across it, and turn rate."""

    speed_m_s: float
    acceleration_m_s2: float
    turn_deg_s: float


def travel_closed_curve(
    rng: np.random.Generator, times_s: FloatArray, extent_m: float, limits: Limits
) -> tuple[FloatArray, FloatArray]:
    """Positions (n, 2) and headings (n,) on a random smooth closed curve within a square.

    The curve is a Fourier series with random coefficients that fall as 1/k, stretched to the
    square of side ``extent_m`` about the origin; of several, the one with the mildest bends is
    taken. Along it the speed is as high as the limits allow: a pass forward and one backward
    bound the acceleration, as in Kunz and Stilman, "Time-optimal trajectory generation for path
    following with bounded acceleration and velocity", RSS 2012.
    """
    curves = [_fourier_curve(rng, extent_m) for _ in range(CANDIDATES)]
    position, heading = min(curves, key=lambda curve: _curvature(*curve).max())
    speed = _speed_profile(_curvature(position, heading), _steps_m(position), limits)
    clock = np.append(0.0, np.cumsum(2.0 * _steps_m(position) / (speed[1:] + speed[:-1])))
    at = np.mod(times_s, clock[-1])
    x, y = np.interp(at, clock, position[:, 0]), np.interp(at, clock, position[:, 1])
    return np.column_stack([x, y]), np.interp(at, clock, heading)


def _fourier_curve(rng: np.random.Generator, extent_m: float) -> tuple[FloatArray, FloatArray]:
    """Points (CURVE_POINTS + 1, 2), the last at the first, and unwrapped headings."""
    k = np.arange(1, CURVE_TERMS + 1)
    sines, cosines = rng.normal(size=(2, CURVE_TERMS, 2)) / k[:, np.newaxis]
    phase = np.multiply.outer(np.linspace(0.0, 2.0 * np.pi, CURVE_POINTS + 1), k)
    points = np.sin(phase) @ sines + np.cos(phase) @ cosines
    low, high = points.min(axis=0), points.max(axis=0)
    stretch = extent_m / (high - low)
    tangent = ((k * np.cos(phase)) @ sines - (k * np.sin(phase)) @ cosines) * stretch
    heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    return (points - 0.5 * (low + high)) * stretch, heading


def _steps_m(position: FloatArray) -> FloatArray:
    return np.linalg.norm(np.diff(position, axis=0), axis=1)


def _curvature(position: FloatArray, heading: FloatArray) -> FloatArray:
    """Turn per metre (radians) at each point, the larger of the steps on either side."""
    step = np.abs(np.diff(heading)) / _steps_m(position)
    return np.maximum(np.append(step, step[0]), np.append(step[-1], step))


def _speed_profile(curvature: FloatArray, step_m: FloatArray, limits: Limits) -> FloatArray:
    bend = np.maximum(curvature, 1e-12)
    across = np.sqrt(limits.acceleration_m_s2 / bend)
    turning = np.radians(limits.turn_deg_s) / bend
    allowed = np.minimum(np.minimum(across, turning), limits.speed_m_s) ** 2
    gain = 2.0 * limits.acceleration_m_s2 * step_m
    forward = _bound_rise(allowed, gain)
    return np.sqrt(_bound_rise(forward[::-1], gain[::-1])[::-1])


def _bound_rise(squared_speed: FloatArray, gain: FloatArray) -> FloatArray:
    """Squared speeds lowered until none rises by more than the gain of its step."""
    bounded: list[float] = squared_speed.tolist()
    # Twice round, because the curve is closed: the first lap finds the speed at its start.
    for i, rise in enumerate([*gain.tolist(), *gain.tolist()]):
        here = i % gain.size
        bounded[here + 1] = min(bounded[here + 1], bounded[here] + rise)
        bounded[0] = min(bounded[0], bounded[-1])
    return np.array(bounded)


@dataclass(slots=True)
class Timeline:
    """One coordinate over time, built leg by leg: hold it, or move it with bounded rates."""

    value: float
    _times: list[float] = field(default_factory=list[float])
    _values: list[float] = field(default_factory=list[float])

    def __post_init__(self) -> None:
        self._times.append(0.0)
        self._values.append(self.value)

    @property
    def end_s(self) -> float:
        """Time at which the last leg ends."""
        return self._times[-1]

    def hold_until(self, time_s: float) -> None:
        """Stay where it is until a time that is not before the end."""
        self._times.append(time_s)
        self._values.append(self.value)

    def move_by(self, change: float, rate: float, acceleration: float) -> None:
        """Move, by not 0, at up to ``rate`` per second, from rest to rest, in the least time."""
        distance = abs(change)
        peak = min(rate, float(np.sqrt(distance * acceleration)))
        ramp_s = peak / acceleration
        total_s = distance / peak + ramp_s
        t = np.linspace(0.0, total_s, min(int(total_s / GRAIN_S) + 2, LEG_POINTS))[1:]
        # Area under a trapezoid: the ramp up, the level part, less what the ramp down lacks.
        up, down = np.minimum(t, ramp_s), np.maximum(t - (total_s - ramp_s), 0.0)
        travelled = 0.5 * acceleration * up**2 + peak * np.maximum(t - ramp_s, 0.0)
        travelled -= 0.5 * acceleration * down**2
        self._values += (self.value + np.copysign(travelled, change)).tolist()
        self._times += (self.end_s + t).tolist()
        self.value += change

    def at(self, times_s: FloatArray) -> FloatArray:
        """Values at any times; held after the last leg."""
        return np.interp(times_s, self._times, self._values)
