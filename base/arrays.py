"""Checks that every struct of arrays makes once, on construction."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.integer[Any]]
BoolArray: TypeAlias = NDArray[np.bool_]


def frozen_array(
    values: ArrayLike, dtype: type[Any], shape: tuple[int, ...], name: str
) -> NDArray[Any]:
    """Return `values` as a read-only, contiguous array of exactly this dtype and shape.

    Raises `InputError` if the values do not convert or the shape differs.
    """
    try:
        array = np.array(values, dtype=dtype, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name}: expected {dtype.__name__} values, got {error}") from error
    if array.shape != shape:
        raise InputError(f"{name}: expected shape {shape}, got {array.shape}")
    array.flags.writeable = False
    return array


def require_finite(array: FloatArray, name: str, *, low: float = -np.inf) -> None:
    """Raise InputError unless every value is finite and at least `low`."""
    good = np.isfinite(array) & (array >= low)
    if not good.all():
        first = tuple(int(i[0]) for i in np.nonzero(~good))
        bound = "" if low == -np.inf else f" >= {low:g}"
        raise InputError(f"{name}: expected finite values{bound}, got {array[first]} at {first}")


def refuse_rows(
    wrong: BoolArray, message: Callable[[int], str], *, path: Path, lines: Sequence[int]
) -> None:
    """Raise InputError about the first wrong row of a file, by its line; `message` is of its index.

    Rows are `wrong` and `lines`, (n,).
    """
    if wrong.any():
        row = int(wrong.argmax())
        raise InputError(message(row), path=path, line=lines[row])
