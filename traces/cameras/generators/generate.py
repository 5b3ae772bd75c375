"""Generated camera traces: seeded, smooth, with bounded speeds and turn rates.

===========  =====  ======  ======  =====================================================
kind         speed  turn    height  what the camera does
===========  =====  ======  ======  =====================================================
walk         1.4    120     1.65    wanders on foot, looks about, head bobs at 2 Hz
drive        13.9   40      1.2     drives round, brakes for bends
fly-over     20     45      60      wanders at height, looks 25 degrees down
orbit        5      30      10      circles the centre and looks at it
look-around  0      120     1.65    stands in the centre and turns its head
dash         7      180     1.65    stands for 4 s, runs across, turns, stands again
teleport     0      30      1.65    stands somewhere else every 3 s (cuts), pans
sudden-turn  5      360     1.65    crosses, turns round at once: from few objects to all
trial        7      360     1.65    rests, ramps, steps, edges, turns and dashes: see `trial`
===========  =====  ======  ======  =====================================================

Speeds (m/s, horizontal) and turn rates (degrees/s) are upper bounds, heights (m) are above the
centre's z. 1.4 m/s is a comfortable walk (Bohannon, "Comfortable and maximum walking speed of
adults aged 20-79 years", Age and Ageing 1997); 13.9 m/s is 50 km/h, the usual urban limit;
``sudden-turn`` follows the test path of Gobbetti and Bouvier, "Time-critical multiresolution
rendering of large complex models", section 5: the camera moves until few objects are left in
view, turns suddenly so that many are visible, and moves back. Everything else is assumed.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.random import Generator

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ....base.nearest_names import unknown_name
from ..camera_trace import CameraTrace
from ..orientation import look_along
from ..samples import MAX_COORDINATE_M
from .load_map import half_square
from .motion_paths import Limits, Timeline, travel_closed_curve
from .trial import LENGTH_S, trial_path

MAX_DURATION_S = 6.0 * 3600.0
# The pace of the walk: a step's bob, and how far and how slowly the head looks aside.
STEPS_HZ = 2.0
BOB_M = 0.02
GLANCE_DEG = np.array([20.0, 12.0])
GLANCE_PERIOD_S = np.array([9.0, 5.3])
NOD_DEG = 4.0
NOD_PERIOD_S = 7.0


@dataclass(frozen=True, slots=True)
class _Path:
    """Positions relative to the centre at camera height, and where the camera looks.

    Level and without cuts unless it is said.
    """

    position_m: FloatArray
    heading_rad: FloatArray
    pitch_rad: FloatArray | float = 0.0
    cut: BoolArray | None = None


@dataclass(frozen=True, slots=True)
class Movement:
    """Bounds, height and length of a kind of movement, and the function that makes its path."""

    limits: Limits
    height_m: float
    path: Callable[[Generator, FloatArray, float, "Movement"], _Path]
    length_s: float = 60.0


def generate(
    kind: str,
    *,
    duration_s: float | None = None,
    rate_hz: float = 60.0,
    speed_m_s: float | None = None,
    extent_m: float = 100.0,
    center_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    height_m: float | None = None,
    seed: int = 0,
) -> CameraTrace:
    """Trace of a kind in `KINDS`, over a square of side ``extent_m`` about ``center_m``.

    Samples lie ``1 / rate_hz`` apart and the last at exactly ``duration_s``. The same arguments
    give the same trace. What is None is the kind's own.

    Raises `InputError` if the kind is not known or a number is out of its range.
    """
    chosen = _kind(kind, speed_m_s, height_m)
    duration_s = chosen.length_s if duration_s is None else duration_s
    _check_range("a duration", duration_s, MAX_DURATION_S, "s")
    _check_range("a rate", rate_hz, 1e4, "Hz")
    _check_range("an extent", extent_m, 1e6, "m")
    if not np.all(np.abs((*center_m, chosen.height_m)) <= MAX_COORDINATE_M):
        raise InputError(
            f"expected a centre and height within {MAX_COORDINATE_M:.0e} m, got {center_m} and "
            f"{chosen.height_m}; give metres"
        )
    if seed < 0:
        raise InputError(f"expected a seed of at least 0, got {seed}; give a whole number")
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    times = _sample_times(duration_s, rate_hz)
    path = chosen.path(rng, times, extent_m, chosen)
    return CameraTrace(
        f"{kind}-{seed}",
        times,
        path.position_m + np.array(center_m) + np.array([0.0, 0.0, chosen.height_m]),
        look_along(path.heading_rad, path.pitch_rad),
        np.zeros(len(times), dtype=np.bool_) if path.cut is None else path.cut,
    )


def _kind(name: str, speed_m_s: float | None, height_m: float | None) -> Movement:
    if name not in KINDS:
        raise InputError(f"kind: {unknown_name(name, KINDS)}")
    chosen = KINDS[name]
    if speed_m_s is not None:
        _check_range("a speed", speed_m_s, 1e4, "m/s")
        if chosen.limits.speed_m_s == 0.0:
            raise InputError(f"expected no speed for {name}, which stands still, got {speed_m_s}")
        chosen = replace(chosen, limits=replace(chosen.limits, speed_m_s=speed_m_s))
    return chosen if height_m is None else replace(chosen, height_m=height_m)


def _check_range(what: str, value: float, largest: float, unit: str) -> None:
    if not 1e-3 <= value <= largest:
        raise InputError(
            f"expected {what} from 0.001 to {largest:g} {unit}, got {value}; give one in this range"
        )


def _sample_times(duration_s: float, rate_hz: float) -> FloatArray:
    inner = np.arange(1, int(duration_s * rate_hz) + 1) / rate_hz
    # A sample closer to the end than 1 % of the interval is the last one, moved to the end.
    return np.concatenate([[0.0], inner[inner < duration_s - 0.01 / rate_hz], [duration_s]])


def _walk(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    glance_rate = 2.0 * np.pi / GLANCE_PERIOD_S
    nod_rate = 2.0 * np.pi / NOD_PERIOD_S
    head_deg_s = float(np.sum(GLANCE_DEG * glance_rate)) + NOD_DEG * nod_rate
    body = replace(kind.limits, turn_deg_s=kind.limits.turn_deg_s - head_deg_s)
    position, heading = travel_closed_curve(rng, times, extent_m, body)
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    glance = np.sin(np.multiply.outer(times, glance_rate) + phase[:2]) @ GLANCE_DEG
    nod = NOD_DEG * (np.sin(nod_rate * times + phase[2]) - 1.0)
    bob = BOB_M * np.sin(2.0 * np.pi * STEPS_HZ * times)
    looking = heading + np.radians(glance)
    return _Path(np.column_stack([position, bob]), looking, np.radians(nod))


def _drive(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    position, heading = travel_closed_curve(rng, times, extent_m, kind.limits)
    return _Path(np.column_stack([position, np.zeros_like(times)]), heading)


def _fly_over(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    flown = _drive(rng, times, extent_m, kind)
    return replace(flown, pitch_rad=float(np.radians(-25.0)))


def _orbit(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    radius_m = 0.5 * extent_m
    rate = min(kind.limits.speed_m_s / radius_m, np.radians(kind.limits.turn_deg_s))
    angle = rng.uniform(0.0, 2.0 * np.pi) + rate * times
    position = radius_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    return _Path(position, angle + np.pi, -float(np.arctan2(kind.height_m, radius_m)))


def _look_around(rng: Generator, times: FloatArray, _extent_m: float, kind: Movement) -> _Path:
    turn_deg_s = kind.limits.turn_deg_s
    heading_deg = Timeline(float(rng.uniform(0.0, 360.0)))
    while heading_deg.end_s < times[-1]:
        turn = float(rng.uniform(30.0, 150.0) * rng.choice([-1.0, 1.0]))
        heading_deg.move_by(turn, turn_deg_s, 4.0 * turn_deg_s)
        heading_deg.hold_until(heading_deg.end_s + float(rng.uniform(0.2, 1.5)))
    return _Path(np.zeros((len(times), 3)), np.radians(heading_deg.at(times)))


def _teleport(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    stay = np.floor(times / 3.0).astype(np.intp)
    count = int(stay[-1]) + 1
    place = rng.uniform(-0.5, 0.5, size=(count, 2)) * extent_m
    heading = rng.uniform(0.0, 2.0 * np.pi, count)
    pan = rng.uniform(-1.0, 1.0, count) * np.radians(kind.limits.turn_deg_s)
    return _Path(
        np.column_stack([place[stay], np.zeros_like(times)]),
        heading[stay] + pan[stay] * (times - 3.0 * stay),
        cut=np.append(False, stay[1:] != stay[:-1]),
    )


def _shuttle(
    rng: Generator,
    times: FloatArray,
    extent_m: float,
    kind: Movement,
    hold_s: float = 0.0,
) -> _Path:
    """Stand, cross the square through its centre, turn round, and again."""
    limits = kind.limits
    direction = rng.uniform(0.0, 2.0 * np.pi)
    along, heading_deg = Timeline(-0.5 * extent_m), Timeline(float(np.degrees(direction)))
    while along.end_s < times[-1]:
        along.hold_until(along.end_s + hold_s)
        along.move_by(-2.0 * along.value, limits.speed_m_s, limits.acceleration_m_s2)
        heading_deg.hold_until(along.end_s)
        heading_deg.move_by(180.0, limits.turn_deg_s, 10.0 * limits.turn_deg_s)
        along.hold_until(heading_deg.end_s)
    ahead = np.array([np.cos(direction), np.sin(direction), 0.0])
    return _Path(np.multiply.outer(along.at(times), ahead), np.radians(heading_deg.at(times)))


def _trial(rng: Generator, times: FloatArray, extent_m: float, kind: Movement) -> _Path:
    plan, heading, cut = trial_path(rng, times, half_square(extent_m), kind.limits)
    return _Path(np.column_stack((plan, np.zeros_like(times))), heading, cut=cut)


# Limits are speed (m/s), acceleration (m/s^2) and turn rate (degrees/s); see the table above.
KINDS: dict[str, Movement] = {
    "walk": Movement(Limits(1.4, 1.0, 120.0), 1.65, _walk),
    "drive": Movement(Limits(13.9, 3.0, 40.0), 1.2, _drive),
    "fly-over": Movement(Limits(20.0, 5.0, 45.0), 60.0, _fly_over),
    "orbit": Movement(Limits(5.0, 1.0, 30.0), 10.0, _orbit),
    "look-around": Movement(Limits(0.0, 1.0, 120.0), 1.65, _look_around),
    "dash": Movement(Limits(7.0, 6.0, 180.0), 1.65, partial(_shuttle, hold_s=4.0)),
    "teleport": Movement(Limits(0.0, 1.0, 30.0), 1.65, _teleport),
    "sudden-turn": Movement(Limits(5.0, 3.0, 360.0), 1.65, _shuttle),
    "trial": Movement(Limits(7.0, 12.0, 360.0), 1.65, _trial, LENGTH_S),
}
