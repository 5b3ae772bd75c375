"""The path ``trial``, made to tell policies apart: every way in which load comes and goes.

=============  ====  =============================================================================
part           s     what the camera does
=============  ====  =============================================================================
rest           2     stands and looks the same way
slow ramp      3     turns slowly from a view of little load to one of much, or back
step up        1     cuts to another place with a view of much load, and stands
step down      1     cuts to another place with a view of little load, and stands
to and fro     2     turns across the edge of what is dense and back, two or three times, and sways
sudden turn    1     turns at once from little load to much, or back, and stands
dash           2     runs ahead
=============  ====  =============================================================================

The times are those of a path of 12 s; others scale.  Order, places and speeds are drawn by seed.
The view is of little load or of much: ramps, steps and turns change which, so they are drawn in an
order in which a step up comes where load is little, and the edge where it is much.  No part begins
with a jump but the steps.  Between the two views there is always something to be seen.
Sudden turns are those of Gobbetti and Bouvier, "Time-critical multiresolution rendering of large
complex models", section 5; the other parts, and all numbers, are assumed.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.random import Generator

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import require_between
from ..camera_trace import CameraTrace
from ..orientation import look_along
from .load_map import HEADINGS, LoadMap
from .motion_paths import Limits

LENGTH_S = 12.0
"""Length at which parts take their times."""

PARTS_S = {"rest": 2, "ramp": 3, "up": 1, "down": 1, "edge": 2, "turn": 1, "dash": 2}
"""Seconds of each part."""

_PLACES = 48  # that are looked at for those that contrast most
_CHOICE = 12  # of which some are taken by chance
_APART = HEADINGS // 6  # least turn between little and much: 60 degrees
_EDGE = HEADINGS // 4  # most turn across an edge: 90 degrees
_EDGE_SHARE = 0.35  # of the difference of load, which goes over the edge
_SWAY_M = 0.5
_SLOWEST = 0.7  # of the largest speeds, from which on speeds are drawn
_RATE_HZ = 60.0

_Motion: TypeAlias = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Takes times (n,) since a part began; returns plans (n, 2) and headings (n,)."""


@dataclass(frozen=True, slots=True)
class _Views:
    """Two views from a place, of little load and of much, (2,) each: little first.

    Attributes
    ----------
    heading_rad : (2,)
        Not wrapped: from one to the other there is something to be seen all the way.
    load : (2,)
    edge_rad : float
        Turn from the view of much over the edge of what is dense.
    """

    eye_m: FloatArray
    heading_rad: FloatArray
    load: FloatArray
    edge_rad: float


@dataclass(slots=True)
class _Camera:
    """Where the camera is and looks between two parts, and which of its views it is in."""

    views: _Views
    eye_m: FloatArray
    heading_rad: float
    much: bool

    @classmethod
    def at(cls, views: _Views, *, much: bool) -> "_Camera":
        """Return a camera in one of the views of a place."""
        return cls(views, views.eye_m, float(views.heading_rad[int(much)]), much)


@dataclass(frozen=True, slots=True)
class _Part:
    """What the camera is to do, for how long, within which limits, and what it is to know."""

    rng: Generator
    load: LoadMap
    limits: Limits
    length_s: float


def trial(
    name: str,
    load: LoadMap,
    limits: Limits,
    *,
    height_m: float,
    duration_s: float,
    seed: int,
) -> CameraTrace:
    """Trial over a map of load with the eye at a height: the same for the same arguments.

    Raises `InputError` if the duration is not above 0 or too long.
    """
    require_between(duration_s, 1e-3, 3600.0, "duration")
    times = np.arange(round(duration_s * _RATE_HZ) + 1) / _RATE_HZ
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    plan, heading, cut = trial_path(rng, times, load, limits)
    position = np.column_stack((plan, np.full(len(times), height_m)))
    return CameraTrace(name, times, position, look_along(heading, np.zeros(len(times))), cut)


def trial_path(
    rng: Generator, times_s: FloatArray, load: LoadMap, limits: Limits
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return plans (n, 2), headings (n,) and cuts (n,) at times from 0 to the path's end."""
    much, order = _draw_order(rng)
    start, *others = _draw_places(rng, load)
    camera, jumps = _Camera.at(start, much=much), False
    plan, heading = np.empty((len(times_s), 2)), np.empty(len(times_s))
    cut = np.zeros(len(times_s), dtype=np.bool_)
    for part, begin_s, end_s in _timetable(order, float(times_s[-1])):
        length_s = end_s - begin_s
        if part in ("up", "down"):
            camera, jumps = _Camera.at(others.pop(), much=part == "up"), True
        motion = _MOVES[part](camera, _Part(rng, load, limits, length_s))
        after = np.inf if part == order[-1] else end_s
        rows = np.flatnonzero((times_s >= begin_s) & (times_s < after))
        plan[rows], heading[rows] = motion(np.minimum(times_s[rows] - begin_s, length_s))
        if len(rows):
            cut[rows[0]], jumps = jumps and rows[0] > 0, False
        (camera.eye_m,), (camera.heading_rad,) = motion(np.array([length_s]))
    return plan, heading, cut


def parts_of(seed: int, duration_s: float = LENGTH_S) -> list[tuple[str, float, float]]:
    """Return the parts of a trial in their order: what, from and to (s)."""
    _, order = _draw_order(np.random.default_rng(np.random.SeedSequence(seed)))
    return list(_timetable(order, duration_s))


def _timetable(order: Sequence[str], duration_s: float) -> Iterator[tuple[str, float, float]]:
    begin_s = 0.0
    for part in order:
        end_s = begin_s + PARTS_S[part] * duration_s / LENGTH_S
        yield part, begin_s, end_s
        begin_s = end_s


def _draw_order(rng: Generator) -> tuple[bool, list[str]]:
    """Return whether the first view is of much, and the parts so that steps are what they say."""
    while True:
        first = much = bool(rng.integers(2))
        order: list[str] = rng.permutation(list(PARTS_S)).tolist()
        for part in order:
            # From a view of little, the edge of what is dense may be too far to reach in time.
            if (part == "up" and much) or (part in ("down", "edge") and not much):
                break
            much ^= part in ("ramp", "up", "down", "turn")
        else:
            return first, order


def _draw_places(rng: Generator, load: LoadMap) -> list[_Views]:
    """Return three places of those with the greatest difference between their views."""
    eyes = [load.draw_eye(rng) for _ in range(_PLACES)]
    views = [view for eye in eyes if (view := _look(load, eye)) is not None]
    if not views:
        middle = _Views(0.5 * (load.low_m + load.high_m), np.zeros(2), np.zeros(2), 0.0)
        return 3 * [middle]
    views.sort(key=lambda view: view.load[0] - view.load[1])
    best = views[:_CHOICE]
    taken = rng.choice(len(best), 3, replace=len(best) < 3)
    return [best[i] for i in taken]


def _look(load: LoadMap, eye_m: FloatArray) -> _Views | None:
    """Return the views from a place, or None where nothing is in view."""
    total, sure = load.around(eye_m)
    if not sure.any():
        return None
    much = int(np.argmax(np.where(sure > 0.0, total, -1.0)))
    turns = [turn for way in (1, -1) for turn in _turns(sure, much, way)]
    far = [turn for turn in turns if abs(turn) >= _APART] or turns or [0]
    turn = min(far, key=lambda steps: total[(much + steps) % HEADINGS])
    steps = np.array((turn, 0))
    seen = total[(much + steps) % HEADINGS]
    step_rad = 2.0 * np.pi / HEADINGS
    return _Views(eye_m, (much + steps) * step_rad, seen, _edge(total, much, turn) * step_rad)


def _turns(sure: FloatArray, much: int, way: int) -> list[int]:
    """Return the turns one way, up to half round, on which something is always in view."""
    ahead = sure[(much + way * np.arange(1, HEADINGS // 2 + 1)) % HEADINGS] > 0.0
    count = len(ahead) if ahead.all() else int(np.argmin(ahead))
    return [way * (i + 1) for i in range(count)]


def _edge(total: FloatArray, start: int, turn: int) -> int:
    """Return the least turn towards the other view over which enough load comes or goes."""
    way, most = int(np.sign(turn)), min(abs(turn), _EDGE)
    wanted = _EDGE_SHARE * abs(total[(start + turn) % HEADINGS] - total[start % HEADINGS])
    for steps in range(1, most):
        if abs(total[(start + way * steps) % HEADINGS] - total[start % HEADINGS]) >= wanted:
            return way * steps
    return way * most


def _stand(camera: _Camera, _: _Part) -> _Motion:
    return _moved(camera, np.zeros(2), 0.0, np.zeros_like)


def _ramp(camera: _Camera, part: _Part) -> _Motion:
    return _turned(camera, part, part.length_s)


def _turn(camera: _Camera, part: _Part) -> _Motion:
    rate = np.radians(part.limits.turn_deg_s) * part.rng.uniform(_SLOWEST, 1.0)
    angle = float(np.abs(np.diff(camera.views.heading_rad)[0]))
    return _turned(camera, part, min(part.length_s, 0.5 * np.pi * angle / rate))


def _turned(camera: _Camera, part: _Part, time_s: float) -> _Motion:
    """Turn to the other view within a time, or as far as the limit allows."""
    camera.much = not camera.much
    angle = float(camera.views.heading_rad[int(camera.much)]) - camera.heading_rad
    most = np.radians(part.limits.turn_deg_s) * time_s * 2.0 / np.pi
    turn = float(np.clip(angle, -most, most))
    return _moved(camera, np.zeros(2), turn, partial(_ease_once, time_s))


def _to_and_fro(camera: _Camera, part: _Part) -> _Motion:
    period_s = part.length_s / int(part.rng.integers(2, 4))
    most = np.radians(part.limits.turn_deg_s) * period_s / np.pi
    ahead, room_m = part.load.lanes(camera.eye_m, camera.heading_rad)[0]
    sway_m = min(_SWAY_M, room_m, part.limits.speed_m_s * period_s / np.pi)
    turn = float(np.clip(camera.views.edge_rad, -most, most))
    return _moved(camera, sway_m * ahead, turn, partial(_ease, 0.5 * period_s))


def _dash(camera: _Camera, part: _Part) -> _Motion:
    speed = part.limits.speed_m_s * part.rng.uniform(_SLOWEST, 1.0)
    longest_m = speed * part.length_s * 2.0 / np.pi
    for share in (1.0, 0.5, 0.25):
        for way, room_m in part.load.lanes(camera.eye_m, camera.heading_rad):
            go = share * longest_m * way
            if share * longest_m <= room_m and _sees(camera, part.load, go):
                return _moved(camera, go, 0.0, partial(_ease, part.length_s))
    return _stand(camera, part)


def _sees(camera: _Camera, load: LoadMap, go_m: FloatArray) -> bool:
    """Return whether something is in view on the way, and in both views and between at its end."""
    steps = np.rint(camera.views.heading_rad * HEADINGS / (2.0 * np.pi)).astype(np.intp)
    arc = np.arange(int(steps.min()), int(steps.max()) + 1) % HEADINGS
    eyes = (camera.eye_m + share * go_m for share in (0.25, 0.5, 0.75, 1.0))
    return all((load.around(eye)[1][arc] > 0.0).all() for eye in eyes)


def _moved(
    camera: _Camera, go_m: FloatArray, turn_rad: float, share: Callable[[FloatArray], FloatArray]
) -> _Motion:
    """Go and turn, by shares of both over time."""
    eye_m, heading_rad = camera.eye_m, camera.heading_rad

    def motion(time_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        done = share(time_s)
        return eye_m + np.multiply.outer(done, go_m), heading_rad + done * turn_rad

    return motion


def _ease(half_period_s: float, time_s: FloatArray) -> FloatArray:
    """Return shares from 0 to 1 and, later, back: half a cosine, its steepest pi / 2 of even."""
    return 0.5 - 0.5 * np.cos(np.pi * time_s / half_period_s)


def _ease_once(length_s: float, time_s: FloatArray) -> FloatArray:
    """Return shares from 0 to 1, and 1 from then on."""
    return _ease(length_s, np.minimum(time_s, length_s))


_MOVES: dict[str, Callable[[_Camera, _Part], _Motion]] = {
    "rest": _stand,
    "ramp": _ramp,
    "up": _stand,
    "down": _stand,
    "edge": _to_and_fro,
    "turn": _turn,
    "dash": _dash,
}
