"""Checks of arrays: conversion, shape, order, read-only, finite."""

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
import pytest

from lodbench.base.arrays import (
    FloatArray,
    IntArray,
    declared_arrays,
    derive,
    freeze,
    frozen_array,
    require_finite,
    sum_rows,
)
from lodbench.base.errors import InputError


@dataclass(frozen=True, slots=True)
class Route:
    """N points and the N + 1 rows at which their segments start."""

    name: str
    point: Annotated[FloatArray, np.float64, "N", 2]
    start: Annotated[IntArray, np.int32, "N + 1"]
    weight: Annotated[FloatArray | None, np.float64, "N"] = None
    length: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        freeze(self, "path", N=len(self.point))
        derive(self, length=np.linalg.norm(self.point, axis=1))


def test_a_struct_holds_what_it_declares() -> None:
    """Arrays take the declared dtype, stay apart from the caller's and cannot be written to."""
    given = np.array([(3, 4), (0, 1)])
    path = Route("a", given, np.array([0, 1, 2]))
    given[0, 0] = 9
    assert path.point.tolist() == [[3.0, 4.0], [0.0, 1.0]]
    assert (path.point.dtype, path.start.dtype) == (np.float64, np.int32)
    assert path.weight is None
    assert path.length.tolist() == [5.0, 1.0]
    assert not any(a.flags.writeable for a in (path.point, path.start, path.length))
    assert declared_arrays(Route)["start"] == (np.int32, ("N + 1",))


@pytest.mark.parametrize(
    ("point", "start", "message"),
    [
        (np.zeros((2, 3)), np.zeros(3), r"path point: expected shape \(2, 2\), got \(2, 3\)"),
        (np.zeros((2, 2)), np.zeros(2), r"path start: expected shape \(3,\), got \(2,\)"),
        (np.full((1, 2), np.nan), np.zeros(2), "path point: expected finite values"),
    ],
)
def test_a_struct_refuses_what_it_does_not_declare(
    point: np.ndarray, start: np.ndarray, message: str
) -> None:
    """Another shape, or a value that is not finite, is told by the field's name."""
    with pytest.raises(InputError, match=message):
        Route("a", point, start)


def test_a_frozen_array_is_a_copy_that_cannot_be_written_to() -> None:
    """The caller's array stays writable and apart; the copy has the dtype asked for."""
    given = np.arange(6).reshape(2, 3).T
    frozen = frozen_array(given, np.float64, (3, 2), "values")
    given[0, 0] = 9
    assert frozen.tolist() == [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0]]
    assert frozen.dtype == np.float64
    assert frozen.flags.c_contiguous
    with pytest.raises(ValueError, match="read-only"):
        frozen[0, 0] = 1.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1.0, 2.0], r"values: expected shape \(3,\), got \(2,\)"),
        ([[1.0], [2.0], [3.0]], r"values: expected shape \(3,\), got \(3, 1\)"),
        (["a", "b", "c"], "values: expected float64 values, got could not convert"),
        ([1.0, [2.0], 3.0], "values: expected float64 values, got "),
    ],
)
def test_other_shapes_and_types_are_refused(values: object, message: str) -> None:
    """A wrong shape or something that is no number is named by the array's name."""
    with pytest.raises(InputError, match=message):
        frozen_array(values, np.float64, (3,), "values")  # pyright: ignore[reportArgumentType]  # broken on purpose


def test_the_first_value_that_is_not_finite_is_named() -> None:
    """NaN, infinity and values below the bound are told with their place."""
    require_finite(np.array([1.0, 2.0]), "values", low=1.0)
    with pytest.raises(InputError, match=r"values: expected finite values, got nan at \(1, 0\)"):
        require_finite(np.array([[1.0], [np.nan]]), "values")
    with pytest.raises(InputError, match=r"values: expected finite values >= 1, got 0.5 at \(0,\)"):
        require_finite(np.array([0.5, np.inf]), "values", low=1.0)


@pytest.mark.parametrize("columns", [0, 1, 2730, 2731, 9000])
def test_sums_of_rows_are_those_of_exact_additions(columns: int) -> None:
    """Tables up to 8,192 entries are multiplied at once, larger ones by blocks of columns."""
    rng = np.random.default_rng(3)
    table, weight = rng.uniform(1.0, 2.0, (3, columns)), rng.uniform(1.0, 2.0, columns)
    expected = [math.fsum(row * weight) for row in table]
    assert sum_rows(table, weight) == pytest.approx(expected, rel=1e-13)
