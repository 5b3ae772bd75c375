"""Walls, floor and ceiling of a piece of a room, from inside, with its doors cut out."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ...meshes.shapes import rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from .floor_plan import FloorPlan

WALL_M = 3.2
_DOOR_TOP_M = 2.3
_CELLS = 8  # along each edge of a wall
_BAY_M = 7.5  # longest piece


@dataclass(frozen=True, slots=True)
class Bay:
    """A piece of a room and where its walls are open.

    Attributes
    ----------
    size_m : lengths in x and y
    openings : (axis, end, from, to, up to) in metres of the bay
        Axis 0 is a wall across x; end 0 is the wall at the lower coordinate.
    """

    size_m: tuple[float, float]
    openings: tuple[tuple[int, int, float, float, float], ...]


def split_room(plan: FloorPlan, room: int) -> list[tuple[FloatArray, Bay]]:
    """Return the bays of a room with their lower corners, (2,); bays are open to each other."""
    low, high = plan.low_m[room], plan.high_m[room]
    size = high - low
    axis = int(size.argmax())
    count = max(1, int(np.ceil(float(size[axis]) / _BAY_M - 0.2)))
    step = np.array(size, dtype=np.float64)
    step[axis] /= count
    ends = plan.doors.ends_m[(plan.doors.rooms == room).any(axis=1)]
    bays: list[tuple[FloatArray, Bay]] = []
    for i in range(count):
        corner = low.copy()
        corner[axis] += i * step[axis]
        joints = [(axis, end) for end in (0, 1) if 0 <= i + 2 * end - 1 < count]
        openings = [(a, end, 0.0, float(step[1 - a]), WALL_M) for a, end in joints]
        for door in ends - corner:
            openings += _doors(door, step)
        bays.append((corner, Bay((_cm(step[0]), _cm(step[1])), tuple(sorted(openings)))))
    return bays


def _doors(door: FloatArray, size: FloatArray) -> list[tuple[int, int, float, float, float]]:
    """Return where a door, relative to a bay's corner, opens one of its walls, if anywhere."""
    across = int(np.ptp(door, axis=0).argmin())
    along = 1 - across
    start, stop = sorted(door[:, along].tolist())
    if stop <= 0.0 or start >= size[along]:
        return []
    top = WALL_M if stop - start > 2.0 else _DOOR_TOP_M  # a corridor's open end
    return [
        (across, end, _cm(start), _cm(stop), top)
        for end in (0, 1)
        if abs(door[0, across] - end * size[across]) < 1e-6
    ]


def _cm(value: float) -> float:
    return round(float(value), 2)


def shell_mesh(name: str, bay: Bay, rng: np.random.Generator) -> SurfaceMesh:
    """Return the inside of a bay, its lower corner at the origin."""
    box = rough_box(rng, _CELLS)
    points = (box.vertices + 0.5) * (*bay.size_m, WALL_M)
    faces = box.faces[:, ::-1]
    middle = points[faces].mean(axis=1)
    keep = np.ones(len(faces), dtype=np.bool_)
    for axis, end, start, stop, top in bay.openings:
        # Walls are uneven by a few centimetres; cells are opened whose middle is near the door.
        slack = 0.5 * bay.size_m[1 - axis] / _CELLS
        wall = np.abs(middle[:, axis] - end * bay.size_m[axis]) < 0.1
        along = middle[:, 1 - axis]
        keep &= ~(wall & (along > start - slack) & (along < stop + slack) & (middle[:, 2] < top))
    return clean_surface(name, [MeshPart(points, faces[keep])])
