"""Checks that every struct of arrays makes once, on construction.

A struct is a frozen dataclass that declares its arrays: ``Annotated[IntArray, np.int32, "N", 3]``
gives the dtype, then the shape, in which a name stands for a length that the struct knows.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.integer[Any]]
BoolArray: TypeAlias = NDArray[np.bool_]

_ONE_THREAD = 8192  # entries of a matrix up to which OpenBLAS multiplies a vector by it alone


@cache
def declared_arrays(struct: type[Any]) -> dict[str, tuple[type[Any], tuple[str | int, ...]]]:
    """Return dtype and shape of each array that a struct declares, by name, in order."""
    declared = {field.name: getattr(field.type, "__metadata__", ()) for field in fields(struct)}
    return {name: (given[0], given[1:]) for name, given in declared.items() if given}


def freeze(struct: Any, label: str, **lengths: int) -> None:
    """Make the declared arrays of a struct what it declares: read-only, of its dtypes and shapes.

    None stays None.  Raises `InputError` as `frozen_array`, or if a value is not finite.
    """
    for name, (dtype, declared) in declared_arrays(struct.__class__).items():
        values = getattr(struct, name)
        if values is None:
            continue
        shape = tuple(_length(at, lengths) for at in declared)
        array = frozen_array(values, dtype, shape, f"{label} {name}")
        if array.dtype.kind == "f":
            require_finite(array, f"{label} {name}")
        object.__setattr__(struct, name, array)


def _length(declared: str | int, lengths: Mapping[str, int]) -> int:
    """Return a length of a shape: a number, a name, or a name and one more, as ``N + 1``."""
    name, _, more = str(declared).partition(" + ")
    return lengths[name] + int(more or 0) if name in lengths else int(name)


def derive(struct: Any, **values: Any) -> None:
    """Set derived fields of a frozen dataclass; fresh arrays become read-only as they are."""
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
        object.__setattr__(struct, name, value)


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


def require_finite(
    array: FloatArray, name: str, *, low: float = -np.inf, high: float = np.inf
) -> None:
    """Raise InputError unless every value is finite and `low` to `high`."""
    good = np.isfinite(array) & (array >= low) & (array <= high)
    if not good.all():
        first = tuple(int(i[0]) for i in np.nonzero(~good))
        bound = "" if low == -np.inf else f" >= {low:g}"
        bound += "" if high == np.inf else f" <= {high:g}"
        raise InputError(f"{name}: expected finite values{bound}, got {array[first]} at {first}")


def sum_rows(table: FloatArray, weight: FloatArray) -> list[float]:
    """Return the sum of each row of a table, (k, n), its columns times their weights, (n,).

    The order of additions is the same however many threads BLAS may start.
    """
    if table.size <= _ONE_THREAD:
        return table.dot(weight).tolist()
    total, columns = np.zeros(len(table)), _ONE_THREAD // len(table)
    for start in range(0, len(weight), columns):
        part = slice(start, start + columns)
        total += table[:, part].dot(weight[part])
    return total.tolist()


def refuse_rows(
    wrong: BoolArray, message: Callable[[int], str], *, path: Path, lines: Sequence[int]
) -> None:
    """Raise InputError about the first wrong row of a file, by its line; `message` is of its index.

    Rows are `wrong` and `lines`, (n,).
    """
    if wrong.any():
        row = int(wrong.argmax())
        raise InputError(message(row), path=path, line=lines[row])
