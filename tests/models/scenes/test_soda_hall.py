"""The building: rooms, doors, and how much of it walls hide."""

import numpy as np
import pytest

from lodbench.models.scenes.parts.floor_plan import plan_floor, route_m
from lodbench.models.scenes.soda_hall import FLOORS, STOREY_M, build_soda_hall


def test_177_rooms() -> None:
    """On six floors; rooms of a floor do not overlap, and each has a door."""
    assert sum(FLOORS) == 177
    for rooms in set(FLOORS):
        plan = plan_floor(rooms)
        assert plan.rooms == rooms
        low = np.maximum(plan.low_m[:, None], plan.low_m[None])
        high = np.minimum(plan.high_m[:, None], plan.high_m[None])
        overlap = np.clip(high - low, 0.0, None).prod(axis=2)
        assert np.count_nonzero(overlap > 1e-9) == len(plan.low_m)
        assert set(plan.doors.rooms.ravel().tolist()) == set(range(rooms + 3))


def test_doors_stand_in_the_walls_of_their_rooms() -> None:
    """Both ends lie on the border of both rooms, the left one left of who goes through."""
    plan = plan_floor(30)
    for (a, b), ends in zip(plan.doors.rooms.tolist(), plan.doors.ends_m, strict=True):
        for room in (a, b):
            assert (ends >= plan.low_m[room] - 1e-9).all()
            assert (ends <= plan.high_m[room] + 1e-9).all()
        middles = [(plan.low_m[room] + plan.high_m[room]) / 2.0 for room in (a, b)]
        left, right = ends
        ahead = np.array((-(left - right)[1], (left - right)[0])) * -1.0
        assert (middles[1] - middles[0]) @ ahead > 0.0


def test_the_route_goes_through_doors() -> None:
    """Where it leaves a room it is within a door to the next."""
    plan = plan_floor(30)
    line = np.concatenate(
        [
            a + np.linspace(0.0, 1.0, 400)[:, None] * (b - a)
            for a, b in zip(route_m(), route_m()[1:], strict=False)
        ]
    )
    outside = np.maximum(plan.low_m - line[:, None], line[:, None] - plan.high_m).max(axis=2)
    assert outside.min(axis=1).max() <= 0.0
    room = (outside <= 0.0).argmax(axis=1)
    joined = {frozenset(pair) for pair in plan.doors.rooms.tolist()}
    for at in np.flatnonzero(np.diff(room)):
        assert frozenset((int(room[at]), int(room[at + 1]))) in joined


@pytest.mark.slow
def test_most_of_the_building_is_hidden() -> None:
    """From any room less than a tenth of all nodes can be seen, from a corridor at most a fifth."""
    scene, geometry = build_soda_hall()
    cells = scene.cells
    assert cells is not None
    assert len(geometry) == len(scene.types.levels.error_m)
    seen = [
        int(cells.seen_from(tuple(((low + high) / 2.0).tolist())).sum())
        for low, high in zip(cells.low_m, cells.high_m, strict=True)
    ]
    assert max(seen) < 0.2 * len(scene)
    assert np.median(seen) < 0.1 * len(scene)
    facade = cells.seen_from((-5.0, -5.0, 1.0))
    kinds: list[int] = scene.type_index[facade].tolist()
    names = {scene.types.names[k] for k in kinds}
    assert names == {"facade"}
    lecture = np.bincount(scene.type_index[cells.node_cell == 2 * 32 + 4])
    assert lecture[0] == 90  # chairs
    storey = np.floor(scene.position_m[:, 2] / STOREY_M)
    assert storey.min() == 0.0
    assert storey.max() == 5.0
