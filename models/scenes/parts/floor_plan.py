"""The plan of a floor: three rows of rooms, two corridors between them, one across at the end."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray, IntArray
from .portals import Doors

LENGTH_M = 75.0
DEPTH_M = 8.0
CORRIDOR_M = 3.0
_DOOR_M = 1.2
_LINKED_EVERY = 3  # of the southern rooms, a door leads to the next
# South row, corridor A, core, corridor B, north row: where each begins in y.
_SOUTH, _A, _CORE, _B, _NORTH = 0.0, 8.0, 11.0, 19.0, 22.0
_ROW = 10  # rooms of the southern and the core row


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """R rooms, then corridor A, corridor B and the one across, as boxes in plan.

    Attributes
    ----------
    low_m, high_m : (R + 3, 2) float64
    doors : Doors
    """

    low_m: FloatArray
    high_m: FloatArray
    doors: Doors

    @property
    def rooms(self) -> int:
        """Rooms without the corridors."""
        return len(self.low_m) - 3


def plan_floor(rooms: int) -> FloorPlan:
    """Return the plan of a floor: ten rooms south, ten in the core, the rest, if any, north."""
    low, high = _row(_SOUTH, _ROW), _row(_CORE, _ROW)
    north = _row(_NORTH, rooms - 2 * _ROW)
    boxes = np.concatenate((low, high, north))
    halls = np.array(
        (
            (0.0, _A, LENGTH_M, _A + CORRIDOR_M),
            (0.0, _B, LENGTH_M, _B + CORRIDOR_M),
            (LENGTH_M, _A, LENGTH_M + CORRIDOR_M, _B + CORRIDOR_M),
        )
    )
    boxes = np.concatenate((boxes, halls))
    return FloorPlan(boxes[:, :2], boxes[:, 2:], _doors(boxes, rooms))


def _row(y_m: float, count: int) -> FloatArray:
    edge = np.linspace(0.0, LENGTH_M, count + 1)
    y = np.full(count, y_m)
    return np.stack((edge[:-1], y, edge[1:], y + DEPTH_M), axis=1)


def _doors(boxes: FloatArray, rooms: int) -> Doors:
    """Return doors to the corridors, between some southern rooms, and the corridors' open ends."""
    a, b, across = rooms, rooms + 1, rooms + 2
    pairs: list[tuple[int, int]] = []
    ends: list[tuple[tuple[float, float], tuple[float, float]]] = []
    half = _DOOR_M / 2.0
    for room in range(rooms):
        x = float(boxes[room, [0, 2]].mean())
        if room < _ROW:  # south: the corridor lies to the north
            pair, y = (room, a), _A
        elif room < 2 * _ROW:
            pair, y = ((room, b), _B) if room % 2 else ((a, room), _CORE)
        else:
            pair, y = (b, room), _NORTH
        pairs.append(pair)
        ends.append(((x - half, y), (x + half, y)))
    for room in range(0, _ROW - 1, _LINKED_EVERY):
        x, y = float(boxes[room, 2]), 2.0
        pairs.append((room, room + 1))
        ends.append(((x, y + half), (x, y - half)))
    for hall, y in ((a, _A), (b, _B)):
        pairs.append((hall, across))
        ends.append(((LENGTH_M, y + CORRIDOR_M), (LENGTH_M, y)))
    joins: IntArray = np.array(pairs)
    return Doors(joins, np.array(ends))


def route_m() -> FloatArray:
    """Return a way through doors, (n, 2): two rooms, both corridors, a room on the other side."""
    plan = plan_floor(3 * _ROW)
    middle = (plan.low_m + plan.high_m) / 2.0
    first, second, last = middle[0], middle[1], middle[2 * _ROW + 2]
    in_a, in_b = _A + CORRIDOR_M / 2.0, _B + CORRIDOR_M / 2.0
    end = LENGTH_M + CORRIDOR_M / 2.0
    return np.array(
        (
            first,
            (first[0] + 1.5, 2.0),
            (LENGTH_M / _ROW, 2.0),
            (second[0] - 1.5, 2.0),
            second,
            (second[0], in_a),
            (end, in_a),
            (end, in_b),
            (last[0], in_b),
            last,
        )
    )
