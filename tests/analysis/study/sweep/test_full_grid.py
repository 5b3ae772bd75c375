"""Grids with holes, and what is left of them."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from lodbench.analysis.study.sweep.full_grid import find_full_grid
from lodbench.base.errors import InputError

AXES = ["policy", "first", "scene", "budget_ms", "refresh_hz", "seed"]
Row = dict[str, Any]


def rows(**axes: list[Any]) -> list[Row]:
    """Return a row for each combination, with status ok."""
    found: list[Row] = [{}]
    for name, values in axes.items():
        found = [row | {name: value} for row in found for value in values]
    return [row | {"status": "ok"} for row in found]


def table(given: list[Row]) -> pa.Table:
    """Return rows as a table that has every axis."""
    whole = [dict.fromkeys(AXES) | {"policy": "a"} | row for row in given]
    return pa.Table.from_pylist(whole)


def test_a_full_grid_is_itself() -> None:
    """Axes with one value are none, and rows stand at their values in the order of the table."""
    grid = find_full_grid(table(rows(scene=["x", "y"], budget_ms=[1, 2, 3], seed=[0, 1])), AXES)
    assert grid.axes == ("scene", "budget_ms")
    assert grid.notes == ()
    assert np.array_equal(grid.rows, np.arange(12).reshape(2, 3, 2))


def test_a_policy_that_does_not_fit_a_scene_is_left_out() -> None:
    """It lacks half of its runs, where the scene lacks a third: the policy goes, and is named."""
    given = rows(policy=["a", "b", "c"], scene=["x", "y"], seed=[0, 1])
    for row in given:
        if (row["policy"], row["scene"]) == ("b", "y"):
            row["status"] = "not-applicable"
    grid = find_full_grid(table(given), AXES)
    assert grid.axes == ("policy", "scene")
    assert grid.notes == ("policy: left out, as runs are missing: b",)
    assert np.array_equal(grid.rows, [[[0, 1], [2, 3]], [[8, 9], [10, 11]]])


def test_a_seed_with_a_failure_is_left_out() -> None:
    """Of one run that failed, what costs the fewest runs goes: here a seed of four."""
    given = rows(scene=["x", "y"], seed=[0, 1, 2, 3])
    given[6]["status"] = "failed"
    grid = find_full_grid(table(given), AXES)
    assert grid.notes == ("seed: left out, as runs are missing: 2",)
    assert np.array_equal(grid.rows, [[0, 1, 3], [4, 5, 7]])


def test_parameters_of_one_policy_are_joined_to_it() -> None:
    """Where policies differ, each with its parameter is a value; of one policy it is an axis."""
    own = rows(policy=["a"], first=[0.1, 0.2], scene=["x", "y"], seed=[0, 1])
    other = rows(policy=["b"], scene=["x", "y"], seed=[0, 1])
    grid = find_full_grid(table(own + other), AXES)
    assert grid.axes == ("policy", "scene")
    assert grid.rows.shape == (3, 2, 2)
    assert "choose one with --where to have first as axes" in grid.notes[0]
    assert find_full_grid(table(own), AXES).axes == ("first", "scene")


def test_an_axis_that_follows_from_another_is_one_with_it() -> None:
    """A budget of one refresh differs just where the display does."""
    given = rows(refresh_hz=[50, 100], scene=["x", "y"], seed=[0, 1])
    for row in given:
        row["budget_ms"] = 1e3 / row["refresh_hz"]
    grid = find_full_grid(table(given), AXES)
    assert set(grid.axes) == {"scene", "refresh_hz"}
    assert grid.notes == ("budget_ms: follows from refresh_hz, and is one with it",)


def test_a_diagonal_has_no_grid() -> None:
    """Runs that never share a value on two axes say nothing of either, and are refused."""
    given = [
        row
        for row in rows(scene=["x", "y"], seed=[0, 1])
        if (row["scene"] == "x") == (not row["seed"])
    ]
    with pytest.raises(InputError, match="expected two values of an axis in a full grid of runs"):
        find_full_grid(table(given), AXES)
    failed = [row | {"status": "failed"} for row in given]
    with pytest.raises(InputError, match="expected runs with scores, got none"):
        find_full_grid(table(failed), AXES)
