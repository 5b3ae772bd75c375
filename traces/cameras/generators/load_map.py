"""Where a scene's load is, seen from above: what a path needs to know to meet little and much."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....base.arrays import FloatArray

HEADINGS = 72
"""Headings that are told apart, evenly round the circle from +x counter-clockwise."""

_HALF_VIEW = 9  # steps of 5 degrees: 45 on either side, a screen of 16:9 that is 60 degrees high
_HALF_SURE = 5  # what lies within 25 degrees is in view on any screen that is not upright
_CELLS = 64  # on either side of the plan; more objects than cells are summed up by cell


@dataclass(frozen=True, slots=True)
class LoadMap:
    """Load by place, and where the eye may be.

    Attributes
    ----------
    place_m : (n, 2) float64
        Plan of what is drawn, n >= 1.
    load : (n,) float64
        What drawing it at full detail costs, in any unit.
    low_m, high_m : (2,) float64
        The rectangle that the eye stays in.
    way_m : (w, 2) float64 or None
        A polyline that the eye stays on instead, where a plan has walls.
    """

    place_m: FloatArray
    load: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    way_m: FloatArray | None = None

    @classmethod
    def of(
        cls,
        place_m: FloatArray,
        load: FloatArray,
        center_m: FloatArray,
        size_m: FloatArray,
        way_m: FloatArray | None = None,
    ) -> "LoadMap":
        """Return a map over a plan; where there are many objects, of the cells of a grid."""
        low, high = center_m - 0.5 * size_m, center_m + 0.5 * size_m
        if len(place_m) > _CELLS**2:
            place_m, load = _by_cell(place_m, load)
        return cls(place_m, load, low, high, way_m)

    def around(self, eye_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the load in view by heading, (HEADINGS,), and that in the middle of the view."""
        x, y = (self.place_m - eye_m).T
        # Seen from inside a thing, it has no direction.
        far = np.hypot(x, y) > 1e-6
        step = np.rint(np.arctan2(y[far], x[far]) * HEADINGS / (2.0 * np.pi)).astype(np.intp)
        # numpy's stubs say that bincount returns integers with weights too.
        by_step: Any = np.bincount(step % HEADINGS, self.load[far], HEADINGS)
        return _window(by_step, _HALF_VIEW), _window(by_step, _HALF_SURE)

    def draw_eye(self, rng: np.random.Generator) -> FloatArray:
        """Return a place for the eye, (2,), evenly over the rectangle or along the way."""
        if self.way_m is None:
            return rng.uniform(self.low_m, self.high_m)
        length = np.linalg.norm(np.diff(self.way_m, axis=0), axis=1)
        along = np.append(0.0, np.cumsum(length))
        at = rng.uniform(0.0, float(along[-1]))
        return np.array([np.interp(at, along, self.way_m[:, i]) for i in range(2)])

    def lanes(self, eye_m: FloatArray, heading_rad: float) -> list[tuple[FloatArray, float]]:
        """Return the directions in which an eye can go straight on, ahead first, and how far."""
        ahead = np.array((np.cos(heading_rad), np.sin(heading_rad)))
        if self.way_m is None:
            return [(way, self._room_m(eye_m, way)) for way in (ahead, -ahead)]
        start, leg = self.way_m[:-1], np.diff(self.way_m, axis=0)
        squared = np.maximum((leg * leg).sum(axis=1), 1e-12)
        share = np.clip(((eye_m - start) * leg).sum(axis=1) / squared, 0.0, 1.0)
        off = np.linalg.norm(start + share[:, None] * leg - eye_m, axis=1)
        # Of legs that go through the eye, the one with the most room.
        here = int(np.argmax(np.where(off < off.min() + 1e-6, squared, 0.0)))
        length = float(np.sqrt(squared[here]))
        along, gone = leg[here] / length, float(share[here])
        lanes = [(along, (1.0 - gone) * length), (-along, gone * length)]
        return lanes if along @ ahead >= 0.0 else lanes[::-1]

    def _room_m(self, eye_m: FloatArray, direction: FloatArray) -> float:
        """Return how far it is to the rectangle's border."""
        border = np.where(direction > 0.0, self.high_m, self.low_m)
        far = np.divide(border - eye_m, direction, out=np.full(2, np.inf), where=direction != 0.0)
        return max(0.0, float(far.min()))


def half_square(extent_m: float) -> LoadMap:
    """Return a square about the origin with all its load evenly over the half beyond x = 0."""
    x, y = (
        axis.ravel()
        for axis in np.meshgrid(np.linspace(0.02, 0.48, 12), np.linspace(-0.48, 0.48, 24))
    )
    place = extent_m * np.stack((x, y), axis=1)
    return LoadMap.of(place, np.ones(len(place)), np.zeros(2), np.full(2, extent_m))


def _window(by_step: FloatArray, half: int) -> FloatArray:
    """Return circular sums over a step and `half` on either side, (HEADINGS,)."""
    around = np.concatenate((by_step[-half:], by_step, by_step[:half]))
    # Not by a running sum: what is empty must be 0, without a rest of rounding.
    return np.convolve(around, np.ones(2 * half + 1), mode="valid")


def _by_cell(place_m: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the middles of the cells that hold load, and their loads."""
    low, size = place_m.min(axis=0), np.maximum(np.ptp(place_m, axis=0), 1e-9)
    cell = np.minimum((place_m - low) / size * _CELLS, _CELLS - 1).astype(np.intp)
    total: Any = np.bincount(cell[:, 0] * _CELLS + cell[:, 1], load, _CELLS**2)
    held = np.flatnonzero(total)
    middle = np.stack(np.divmod(held, _CELLS), axis=1) + 0.5
    return low + middle / _CELLS * size, total[held]
