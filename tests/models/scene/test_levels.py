"""Tables of levels: what they refuse, and interpolation against numpy's."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.scene.levels import LevelTable

MakeLevels = Callable[..., LevelTable]
TRIANGLES = LEVEL_PREDICTORS.index("triangles")


def test_derived_columns_by_hand(make_levels: MakeLevels) -> None:
    """Resolutions are shares of the finest level's triangles; every row knows its type."""
    levels = make_levels([(1000, 250, 50), (80,)])
    assert levels.start.tolist() == [0, 3, 4]
    assert levels.resolution.tolist() == [1.0, 0.25, 0.05, 1.0]
    assert levels.level_count.tolist() == [3, 1]
    assert levels.min_resolution.tolist() == [0.05, 1.0]
    assert levels.type_of_level.tolist() == [0, 0, 0, 1]


def test_a_table_cannot_be_written_to(make_levels: MakeLevels) -> None:
    """Arrays are copies of what was given, and read-only."""
    levels = make_levels()
    with pytest.raises(ValueError, match="read-only"):
        levels.counts[0, 0] = 1.0


def test_splats_and_triangles_are_primitives_alike() -> None:
    """A type of splats has the same resolutions as one of triangles."""
    counts = np.zeros((2, len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("splats")] = (64, 16)
    levels = LevelTable(np.array([0, 2]), counts, np.zeros(2), np.zeros(2), np.array([True]))
    assert levels.resolution.tolist() == [1.0, 0.25]


def test_discrete_positions_are_rows(make_levels: MakeLevels) -> None:
    """Level i of a type is the i-th of its rows, with no fraction."""
    levels = make_levels([(1000, 250, 50), (80, 20)])
    row, fraction = levels.position(np.array([1, 0, 0, 1]), np.array([0.0, 2.0, 1.0, 1.0]))
    assert row.tolist() == [3, 2, 1, 4]
    assert fraction.tolist() == [0.0, 0.0, 0.0, 0.0]
    assert levels.interpolate(levels.error_m, row, fraction).tolist() == [0.0, 0.2, 0.1, 0.1]


def test_continuous_positions_by_hand(make_levels: MakeLevels) -> None:
    """Resolution 0.625 lies halfway between the knots 1 and 0.25."""
    levels = make_levels([(1000, 250, 50)], continuous=True)
    row, fraction = levels.position(np.zeros(4, dtype=int), np.array([1.0, 0.625, 0.25, 0.05]))
    assert row.tolist() == [0, 0, 1, 1]
    assert fraction == pytest.approx([0.0, 0.5, 0.0, 1.0])
    triangles = levels.interpolate(levels.counts, row, fraction)[:, TRIANGLES]
    assert triangles == pytest.approx([1000, 625, 250, 50])


def test_discrete_and_continuous_types_mix(make_levels: MakeLevels) -> None:
    """In one call each type is read in its own way; a continuous type may have a single level."""
    levels = make_levels([(100, 50), (100, 50), (10,)], continuous=[False, True, True])
    row, fraction = levels.position(np.array([0, 1, 2, 0]), np.array([1.0, 0.75, 1.0, 0.0]))
    assert row.tolist() == [1, 2, 4, 0]
    assert fraction == pytest.approx([0.0, 0.5, 0.0, 0.0])


chains = st.lists(st.integers(1, 10_000), min_size=1, max_size=7, unique=True).map(
    lambda values: sorted(values, reverse=True)
)


@given(st.lists(chains, min_size=1, max_size=4), st.data())
def test_interpolation_agrees_with_numpy(
    make_levels: MakeLevels, triangles: list[list[int]], data: st.DataObject
) -> None:
    """Triangles and error at any resolution are those of ``np.interp`` over the type's knots."""
    levels = make_levels(triangles, continuous=True)
    kind = data.draw(st.integers(0, len(triangles) - 1))
    knots = np.array(triangles[kind]) / triangles[kind][0]
    detail = np.array(data.draw(st.lists(st.floats(knots[-1], 1.0), min_size=1, max_size=5)))
    row, fraction = levels.position(np.full(len(detail), kind), detail)
    own = slice(levels.start[kind], levels.start[kind + 1])
    for column in (levels.counts[:, TRIANGLES], levels.error_m):
        expected = np.interp(detail, knots[::-1], column[own][::-1])
        assert levels.interpolate(column, row, fraction) == pytest.approx(expected, rel=1e-6)
    assert ((row >= own.start) & (row < own.stop)).all()
    assert ((fraction >= 0.0) & (fraction <= 1.0)).all()


def parts(**changes: object) -> dict[str, object]:
    """Return the arguments of a small good table with some replaced."""
    counts = np.zeros((3, len(LEVEL_PREDICTORS)))
    counts[:, TRIANGLES] = (100, 50, 10)
    good = {
        "start": np.array([0, 2, 3]),
        "counts": counts,
        "error_m": np.array([0.0, 0.1, 0.0]),
        "bytes": np.zeros(3),
        "continuous": np.zeros(2, dtype=bool),
    }
    return {**good, **changes}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bytes": np.full(3, 1e300)}, "level bytes: expected finite values >= 0 <= 9.0072e"),
        ({"start": np.array([0, 3, 3])}, "expected every type to own at least one level"),
        ({"start": np.array([1, 2, 3])}, "expected every type to own at least one level"),
        ({"start": np.array([0, 2, 4])}, "expected every type to own at least one level"),
        ({"start": np.array([0])}, "expected every type to own at least one level"),
        ({"error_m": np.array([0.0, np.nan, 0.0])}, "level error_m: expected finite"),
        ({"bytes": np.array([0.0, -1.0, 0.0])}, "level bytes: expected finite values >= 0"),
        ({"bytes": np.zeros(2)}, "level bytes: expected shape"),
        ({"error_m": np.array([0.2, 0.1, 0.0])}, "levels of type 0: expected finest first"),
        ({"error_m": ["a", "b", "c"]}, "level error_m: expected float64 values"),
        ({"counts": np.zeros((3, 2))}, "level counts: expected shape"),
    ],
)
def test_broken_tables_are_refused(changes: dict[str, object], message: str) -> None:
    """Each rule has its own error, which says what was expected."""
    LevelTable(**parts())  # pyright: ignore[reportArgumentType]  # checked at run time
    if changes.get("start") is not None and len(np.asarray(changes["start"])) == 1:
        changes = {**changes, "continuous": np.zeros(0, dtype=bool)}
    with pytest.raises(InputError, match=message):
        LevelTable(**parts(**changes))  # pyright: ignore[reportArgumentType]


def test_levels_that_grow_with_coarseness_are_refused(make_levels: MakeLevels) -> None:
    """A second level with more triangles than the first is named by type and level."""
    with pytest.raises(InputError, match=r"levels of type 1: .*got 90 primitives.*at level 1"):
        make_levels([(10, 5), (80, 90)])
