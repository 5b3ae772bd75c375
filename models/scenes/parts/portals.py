"""Which rooms can be seen from which through doors, on the plan of a floor.

Teller and Séquin (SIGGRAPH 1991), in two dimensions: a chain of doors lets a line through if one
line separates all their left ends from all their right ends.
"""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import BoolArray, FloatArray

_ROUNDING_M = 1e-9


@dataclass(frozen=True, slots=True)
class Doors:
    """D openings between rooms.

    Attributes
    ----------
    rooms : (D, 2) int
        The two rooms that each joins.
    ends_m : (D, 2, 2) float64
        Both ends in plan; the left one first, seen from the first room.
    """

    rooms: np.ndarray
    ends_m: FloatArray


def potentially_visible(rooms: int, doors: Doors) -> BoolArray:
    """Return which rooms may be seen from which, (rooms, rooms); symmetric."""
    seen = np.eye(rooms, dtype=np.bool_)
    through: list[list[tuple[int, int, int]]] = [[] for _ in range(rooms)]
    for door, (a, b) in enumerate(doors.rooms.tolist()):
        through[a].append((door, b, 1))
        through[b].append((door, a, -1))
    for start in range(rooms):
        stack: list[tuple[int, tuple[int, ...], FloatArray, FloatArray]] = [
            (start, (start,), np.empty((0, 2)), np.empty((0, 2)))
        ]
        while stack:
            room, chain, left, right = stack.pop()
            for door, beyond, way in through[room]:
                if beyond in chain:
                    continue
                ends = doors.ends_m[door][::way]
                lefts, rights = np.vstack((left, ends[:1])), np.vstack((right, ends[1:]))
                if _line_between(lefts, rights):
                    seen[start, beyond] = True
                    stack.append((beyond, (*chain, beyond), lefts, rights))
    return seen | seen.T


def _line_between(left: FloatArray, right: FloatArray) -> bool:
    """Whether a line has all of `left` on its left or on it, and all of `right` on its right.

    If one has, it can be moved until it goes through a point of each.
    """
    for a in left:
        for b in right:
            for ahead in (b - a, a - b):
                normal = np.array((-ahead[1], ahead[0]))
                room = _ROUNDING_M * max(1.0, float(np.abs(ahead).max()))
                if ((left - a) @ normal >= -room).all() and ((right - a) @ normal <= room).all():
                    return True
    return False
