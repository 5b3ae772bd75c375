"""Which tiles are left where others cannot be drawn, on trees worked out by hand."""

import numpy as np
import pytest

from lodbench.models.tiles.tile_holes import keep_from_holes

# A root with children 1 and 2; 1 has 3 and 4; 2 has 5.
PARENT = [-1, 0, 0, 1, 1, 2]


def kept(
    missing: list[int], *, empty: tuple[int, ...] = (), additive: tuple[int, ...] = ()
) -> list[int]:
    """Return the tiles left: `missing` have content that cannot be read, `empty` have none."""
    whole = np.ones(6, dtype=np.bool_)
    whole[missing] = False
    solid = whole.copy()
    solid[list(empty)] = False
    adds, none = [i in additive for i in range(6)], np.isin(np.arange(6), empty)
    keep = keep_from_holes(PARENT, adds, solid, whole, none)
    return np.flatnonzero(keep).tolist()


@pytest.mark.parametrize(
    ("missing", "left"),
    [
        ([], [0, 1, 2, 3, 4, 5]),
        ([3], [0, 1, 2, 5]),  # 1 keeps standing for both of its children
        ([3, 5], [0, 1, 2]),
        ([1], [0, 1, 2, 3, 4, 5]),  # passed through: 3 and 4 take its place
        ([1, 3], [0]),  # nothing can take the place of 1, so that the root is not replaced
        ([0, 1, 3], [0, 1, 2, 3, 4, 5]),  # nothing above can be drawn: a hole it is
    ],
)
def test_what_is_missing_never_replaces(missing: list[int], left: list[int]) -> None:
    """A parent with geometry is a leaf where one below it would be a hole."""
    assert kept(missing) == left


def test_beside_what_stays_only_the_missing_goes() -> None:
    """Below a tile that adds, 3 goes and 4 stays; an inner one goes with what has a hole below."""
    assert kept([3], additive=(1,)) == [0, 1, 2, 4, 5]
    assert kept([1, 3], additive=(0,)) == [0, 2, 5]


def test_a_tile_without_content_is_no_hole() -> None:
    """What is empty by design has nothing to draw and goes, unless there is nothing else."""
    assert kept([], empty=(3,)) == [0, 1, 2, 4, 5]
    assert kept([], empty=(1, 3, 4)) == [0, 2, 5]
    assert kept([], empty=(1,)) == [0, 1, 2, 3, 4, 5]
    assert kept([4], empty=(1,)) == [0]
    assert kept([], empty=(0, 1, 2, 3, 4, 5)) == [0, 1, 2, 3, 4, 5]
