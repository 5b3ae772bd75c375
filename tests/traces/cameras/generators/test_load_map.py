"""Where load is: hand-placed objects, and grids that lose none of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.traces.cameras.generators.load_map import HEADINGS, LoadMap

EAST, NORTH, WEST, SOUTH = 0, HEADINGS // 4, HEADINGS // 2, 3 * HEADINGS // 4


def square_map(place: list[list[float]], load: list[float], way: object = None) -> LoadMap:
    """Return a map over the square of 100 m about the origin."""
    way_m = None if way is None else np.array(way, dtype=np.float64)
    return LoadMap.of(np.array(place), np.array(load), np.zeros(2), np.full(2, 100.0), way_m)


def test_two_objects_are_seen_where_they_are() -> None:
    """Of 5 in the east and 7 in the north, each is in its quarter, and both half way between."""
    total, sure = square_map([[10.0, 0.0], [0.0, 20.0]], [5.0, 7.0]).around(np.zeros(2))
    assert total[[EAST, NORTH, WEST, SOUTH]].tolist() == [5.0, 7.0, 0.0, 0.0]
    assert total[HEADINGS // 8] == 12.0
    assert sure[HEADINGS // 8] == 0.0
    # 45 degrees on either side are 19 of 72 headings, 25 degrees are 11.
    assert np.count_nonzero(total == 7.0) + np.count_nonzero(total == 12.0) == 19
    assert np.count_nonzero(sure == 7.0) == 11


def test_eye_within_an_object_sees_the_others() -> None:
    """What is at the eye has no direction and counts in none."""
    total, _ = square_map([[3.0, 3.0], [3.0, 13.0]], [100.0, 1.0]).around(np.array([3.0, 3.0]))
    assert total.max() == 1.0
    assert total[NORTH] == 1.0


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32), count=st.integers(4_097, 20_000))
def test_cells_keep_the_load_and_its_place(seed: int, count: int) -> None:
    """Many objects are summed up by cell: the sum stays, its middle moves by less than a cell."""
    rng = np.random.default_rng(seed)
    place, load = rng.normal(0.0, 20.0, (count, 2)), rng.exponential(3.0, count)
    cells = LoadMap.of(place, load, np.zeros(2), np.full(2, 100.0))
    assert len(cells.place_m) <= 64 * 64
    assert cells.load.sum() == pytest.approx(load.sum())
    moved = np.average(cells.place_m, axis=0, weights=cells.load) - np.average(
        place, axis=0, weights=load
    )
    assert (np.abs(moved) < np.ptp(place, axis=0) / 64.0).all()


def test_eyes_fill_the_rectangle_or_the_way() -> None:
    """Without a way all quarters of the plan are drawn; with one, only places on it."""
    rng = np.random.default_rng(0)
    free = square_map([[0.0, 0.0]], [1.0])
    eyes = np.array([free.draw_eye(rng) for _ in range(200)])
    assert np.abs(eyes).max() <= 50.0
    assert len({(x > 0.0, y > 0.0) for x, y in eyes.tolist()}) == 4
    way = square_map([[0.0, 0.0]], [1.0], [[0.0, 0.0], [30.0, 0.0], [30.0, 10.0]])
    eyes = np.array([way.draw_eye(rng) for _ in range(400)])
    on_first = (eyes[:, 1] == 0.0) & (eyes[:, 0] >= 0.0) & (eyes[:, 0] <= 30.0)
    on_second = (eyes[:, 0] == 30.0) & (eyes[:, 1] >= 0.0) & (eyes[:, 1] <= 10.0)
    assert (on_first | on_second).all()
    assert on_first.mean() == pytest.approx(0.75, abs=0.1)  # of 40 m, 30 are on the first leg


def test_lanes_end_at_the_border_or_the_corner() -> None:
    """From (10, 0) it is 40 m east and 60 m west; on the way 20 m to its corner and 10 m back."""
    free = square_map([[0.0, 0.0]], [1.0])
    (ahead, far), (back, near) = free.lanes(np.array([10.0, 0.0]), 0.0)
    assert (ahead.tolist(), far) == ([1.0, 0.0], pytest.approx(40.0))
    assert (back.tolist(), near) == ([-1.0, 0.0], pytest.approx(60.0))
    way = square_map([[0.0, 0.0]], [1.0], [[0.0, 0.0], [30.0, 0.0], [30.0, 10.0]])
    lanes = way.lanes(np.array([10.0, 0.0]), np.radians(170.0))
    assert [(step.tolist(), room) for step, room in lanes] == [
        ([-1.0, 0.0], pytest.approx(10.0)),
        ([1.0, 0.0], pytest.approx(20.0)),
    ]
