"""Checks of arrays: conversion, shape, order, read-only, finite."""

import numpy as np
import pytest

from lodbench.base.arrays import frozen_array, require_finite
from lodbench.base.errors import InputError


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
