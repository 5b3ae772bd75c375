"""A likeness of Soda Hall, the building that Funkhouser and Séquin walked through.

Six floors with 177 rooms, as in the public model of the building; the rooms themselves are made
up.  Whatever stands in a room, its walls included, is in the room's cell, and is seen only from
there or through doors; floors hide each other, and the outer walls are seen from outside only.
"""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.shapes import rough_box
from ..meshes.simplify import ChainOptions, build_chain
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..meshes.type_model import gather_types
from ..scene.cells import Cells
from ..scene.rotation import turn_about_z
from ..scene.scene import Scene
from .parts.floor_plan import CORRIDOR_M, DEPTH_M, LENGTH_M, FloorPlan, plan_floor
from .parts.furniture import CABINET, CHAIR, COMPUTER, DESK, LAMP, PLANT, SHELF, make_furniture
from .parts.portals import potentially_visible
from .parts.room_shell import Bay, shell_mesh, split_room
from .scene_registry import BundledScene

_SEED = 1993
FLOORS = (29, 29, 29, 30, 30, 30)
"""Rooms of each floor, corridors not counted: 177."""

STOREY_M = 4.0
_PANEL_M = 7.5  # length of a panel of the facade
_LECTURE = (2, 4)  # floor and room of the lecture hall, with 90 chairs
_CHAIN = ChainOptions(levels=4, ratio=0.4, min_triangles=12)
_SAMPLING = Sampling(vertices=2_000, surface=500)
_OFFICE = ((DESK, 2), (CHAIR, 3), (SHELF, 2), (COMPUTER, 2), (LAMP, 1), (PLANT, 1), (CABINET, 2))


def build_soda_hall() -> tuple[Scene, Geometry]:
    """Return the building, its south-west corner at the origin."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    plans = [plan_floor(rooms) for rooms in FLOORS]
    furniture = make_furniture(shape_rng)
    bays: dict[Bay, int] = {}
    kind: list[IntArray] = []
    place: list[FloatArray] = []
    cell: list[IntArray] = []
    yaw: list[FloatArray] = []
    first = 0
    for floor, plan in enumerate(plans):
        lift = np.array((0.0, 0.0, floor * STOREY_M))
        for room in range(len(plan.low_m)):
            pieces, at = _furnish(plan, floor, room, place_rng)
            split = split_room(plan, room)
            corners = np.column_stack(([corner for corner, _ in split], np.zeros(len(split))))
            shells = [len(furniture) + bays.setdefault(bay, len(bays)) for _, bay in split]
            kind += [np.array(shells), pieces]
            place += [corners + lift, at + lift]
            cell.append(np.full(len(pieces) + len(split), first + room))
            quarter = np.concatenate((np.zeros(len(split)), place_rng.integers(0, 4, len(pieces))))
            yaw.append(quarter.astype(np.float64) * (np.pi / 2.0))
        first += len(plan.low_m)
    shells = [shell_mesh(f"bay-{i}", bay, shape_rng) for bay, i in bays.items()]
    meshes = (*furniture, *shells, _panel(shape_rng))
    models = [build_chain(mesh, _CHAIN, _SAMPLING) for mesh in meshes]
    types, geometry = gather_types(models)
    panels, panel_yaw = _facade_panels()
    kind.append(np.full(len(panels), len(models) - 1))
    place.append(panels)
    cell.append(np.full(len(panels), first))
    yaw.append(panel_yaw)
    scene = Scene.of(
        "soda-hall",
        types,
        np.concatenate(kind),
        np.concatenate(place),
        turn_xyzw=turn_about_z(np.concatenate(yaw)),
        cells=_cells(plans, np.concatenate(cell)),
    )
    return scene, geometry


def _furnish(
    plan: FloorPlan, floor: int, room: int, rng: np.random.Generator
) -> tuple[IntArray, FloatArray]:
    """Return kinds and places of what stands in a room; corridors have plants and cabinets."""
    low, high = plan.low_m[room], plan.high_m[room]
    if (floor, room) == _LECTURE:
        row, column = np.divmod(np.arange(90), 10)
        seats = low + 0.9 + np.stack((column * 0.62, row * 0.72), axis=1)
        return np.full(90, CHAIR), np.column_stack((seats, np.zeros(90)))
    wanted = _OFFICE if room < plan.rooms else ((PLANT, 3), (CABINET, 4), (LAMP, 3))
    kind = np.repeat([k for k, _ in wanted], [c for _, c in wanted])
    at = rng.uniform(low + 0.9, high - 0.9, (len(kind), 2))
    z = np.where(kind == COMPUTER, 0.76, 0.0)
    desks = np.flatnonzero(kind == DESK)
    computers = np.flatnonzero(kind == COMPUTER)
    at[computers] = at[desks[: len(computers)]]
    return kind, np.column_stack((at, z))


def _panel(rng: np.random.Generator) -> SurfaceMesh:
    """Return a piece of the outer wall of one storey, 7.5 m long along x."""
    box = rough_box(rng, 6)
    points = (box.vertices + 0.5) * (_PANEL_M, 0.3, STOREY_M)
    return clean_surface("facade", [MeshPart(points, box.faces)])


def _facade_panels() -> tuple[FloatArray, FloatArray]:
    """Return places (n, 3) and turns (n,) of the panels about all storeys."""
    length, depth = LENGTH_M + CORRIDOR_M, 3.0 * DEPTH_M + 2.0 * CORRIDOR_M
    along, up = np.arange(0.0, length, _PANEL_M), np.arange(0.0, depth, _PANEL_M)
    rows = [
        (along, np.full(len(along), -0.3), 0.0),
        (along, np.full(len(along), depth), 0.0),
        (np.zeros(len(up)), up, np.pi / 2.0),
        (np.full(len(up), length + 0.3), up, np.pi / 2.0),
    ]
    plan = np.concatenate([np.stack((x, y), axis=1) for x, y, _ in rows])
    yaw: FloatArray = np.repeat([turn for _, _, turn in rows], [len(x) for x, _, _ in rows])
    z = np.repeat(np.arange(len(FLOORS)) * STOREY_M, len(plan))
    places: FloatArray = np.column_stack((np.tile(plan, (len(FLOORS), 1)), z)).astype(np.float64)
    return places, np.tile(yaw, len(FLOORS))


def _cells(plans: list[FloorPlan], node_cell: IntArray) -> Cells:
    """Return rooms and corridors as cells, and last one for the facade, above the roof."""
    low, high = [np.empty((0, 3))], [np.empty((0, 3))]
    for floor, plan in enumerate(plans):
        rooms = len(plan.low_m)
        low.append(np.column_stack((plan.low_m, np.full(rooms, floor * STOREY_M))))
        high.append(np.column_stack((plan.high_m, np.full(rooms, (floor + 1) * STOREY_M))))
    roof = len(plans) * STOREY_M
    low.append(np.array([[0.0, 0.0, roof]]))
    high.append(np.array([[LENGTH_M, DEPTH_M, roof + STOREY_M]]))
    count = sum(map(len, low))
    visible = np.zeros((count + 1, count), dtype=np.bool_)
    first = 0
    for plan in plans:
        rooms = len(plan.low_m)
        inside = slice(first, first + rooms)
        visible[inside, inside] = potentially_visible(rooms, plan.doors)
        first += rooms
    visible[count - 1 :, count - 1] = True  # from above the roof and from outside
    return Cells(node_cell, np.concatenate(low), np.concatenate(high), visible)


SODA_HALL = BundledScene(
    "a building of six floors and 177 rooms, most of it behind walls", build_soda_hall
)
