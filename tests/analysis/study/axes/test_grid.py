"""Combinations of axes and what is left out of them."""

import pytest

from lodbench.analysis.study.axes import grid as module
from lodbench.analysis.study.axes.grid import Axis, Grid, require_known
from lodbench.base.errors import InputError


def axis(name: str, *values: object) -> Axis:
    """Return an axis whose cells are its values."""
    return Axis(name, values, values)  # pyright: ignore[reportArgumentType]


A, B, C = axis("a", 1, 2), axis("b", "x", "y", "z"), axis("c", None, True)


def test_all_combinations_in_order() -> None:
    """The last axis is the fastest, as digits of a number are."""
    assert list(Grid([A, B])) == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]


def test_an_exclusion_holds_where_all_of_it_does() -> None:
    """Its axes are joined by and, its values by or, and several exclusions by or."""
    grid = Grid([A, B, C], [{"a": (1,), "b": ("x", "z")}, {"c": (True,), "b": ("y",)}])
    left = {(A.cells[i], B.cells[j], C.cells[k]) for i, j, k in grid}
    # By hand: of the 12, (1, x, ·) and (1, z, ·) go by the first, (·, y, True) by the second.
    assert left == {
        (1, "y", None), (2, "y", None), (2, "x", None), (2, "x", True), (2, "z", None),
        (2, "z", True),
    }  # fmt: skip
    assert len(grid) == 6


def test_an_exclusion_of_another_axis_leaves_a_grid_alone() -> None:
    """What names a parameter of one policy takes nothing from another's runs."""
    assert len(Grid([A, B], [{"a": (1,), "first": (0.1,)}])) == 6


def test_occupied_combinations_are_of_what_is_left() -> None:
    """A scene whose every run on a path is excluded need not be loaded with it."""
    grid = Grid([A, B, C], [{"a": (1,), "b": ("x",)}, {"a": (1,), "b": ("y",), "c": (True,)}])
    assert list(grid.occupied("a", "b")) == [(1, "y"), (1, "z"), (2, "x"), (2, "y"), (2, "z")]


def test_a_value_twice_is_refused() -> None:
    """It would be run twice; but a truth value is not the number that it equals."""
    with pytest.raises(InputError, match=r"b: expected each once, got 5\.0 twice"):
        Axis("b", (5, 5.0), (5, 5.0))
    with pytest.raises(InputError, match=r"b: expected each once, got 0\.5 twice"):
        axis("b", 0.5, 1, 0.5)
    assert len(axis("b", True, 1, None).values) == 3
    with pytest.raises(InputError, match="b: expected one value or more, got none"):
        axis("b")


def test_what_cannot_be_listed_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bound is one of combinations, told with both numbers, before any memory is taken."""
    monkeypatch.setattr(module, "MOST_RUNS", 11)
    with pytest.raises(InputError, match=r"at most 11 combinations of its axes, got 12; take"):
        Grid([A, B, C])


@pytest.mark.parametrize(
    ("exclusion", "said"),
    [
        ({"d": (1,)}, "exclude: expected one of a, b, got d"),
        ({"b": ("x", "w")}, "exclude: b: expected one of x, y, z, got w"),
        ({}, "exclude: expected an axis and its values, got none"),
    ],
)
def test_an_exclusion_of_nothing_is_a_mistake(exclusion: dict[str, tuple[str]], said: str) -> None:
    """A misspelt exclusion would silently run what should be left out."""
    with pytest.raises(InputError, match=said):
        require_known([exclusion], [A, B])
