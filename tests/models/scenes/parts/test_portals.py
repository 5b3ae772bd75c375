"""What can be seen through doors: worked out on small plans, and against sampled lines."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.models.scenes.parts.portals import Doors, potentially_visible


def eastward(x_m: float, low_m: float, high_m: float) -> list[list[float]]:
    """Return the ends of a door through which one walks east: the left end lies north."""
    return [[x_m, high_m], [x_m, low_m]]


def test_three_rooms_in_a_row() -> None:
    """Through two doors one always sees, as some line joins them, in line or not."""
    pairs = np.array([[0, 1], [1, 2]])
    for low in (4.0, 9.0):
        doors = Doors(pairs, np.array([eastward(10, 4, 6), eastward(20, low, low + 1.0)]))
        assert potentially_visible(3, doors).all()


def test_a_chain_out_of_line_is_blocked() -> None:
    """Doors at y = 0, 9 and 0 in walls 10 m apart: no line goes down, up and down again."""
    pairs = np.array([[0, 1], [1, 2], [2, 3]])
    ends = [eastward(10, 0, 1), eastward(20, 9, 10), eastward(30, 0, 1)]
    seen = potentially_visible(4, Doors(pairs, np.array(ends)))
    assert seen[0].tolist() == [True, True, True, False]
    assert (seen == seen.T).all()


def test_no_door_no_sight() -> None:
    """A room without doors sees itself only."""
    doors = Doors(np.empty((0, 2), dtype=int), np.empty((0, 2, 2)))
    assert potentially_visible(2, doors).tolist() == [[True, False], [False, True]]


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_every_line_that_gets_through_is_known(seed: int) -> None:
    """Rooms in a row with random doors: rooms that a sampled line reaches are in the set."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, 8.0, 4)
    high = low + rng.uniform(0.5, 2.0, 4)
    ends = np.array([eastward(10.0 * (i + 1), low[i], high[i]) for i in range(4)])
    pairs = np.stack((np.arange(4), np.arange(1, 5)), axis=1)
    seen = potentially_visible(5, Doors(pairs, ends))
    start, slope = rng.uniform(0.0, 10.0, 4000), rng.uniform(-1.0, 1.0, 4000)
    at = start[:, None] + slope[:, None] * 10.0 * np.arange(1, 5)
    through = np.logical_and.accumulate((at > low) & (at < high), axis=1)
    reached = through.any(axis=0)
    assert (seen[0, 1:] >= reached).all()
