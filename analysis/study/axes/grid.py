"""Axes of a study, and the grid of all their combinations."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....base.errors import InputError
from ....base.nearest_names import unknown_name

Cell: TypeAlias = bool | int | float | str | None
"""What a table shows of a value."""

Exclusions: TypeAlias = Sequence[Mapping[str, Collection[Cell]]]
"""Each leaves out the combinations that have one of the named cells on every axis that it names."""

MOST_RUNS = 10_000_000


@dataclass(frozen=True, slots=True)
class Axis:
    """One thing that varies in a study.

    Attributes
    ----------
    name : str
        The column of the results.
    values : tuple
        What runs are made of, such as scenes.
    cells : tuple of Cell
        What results and exclusions call each value.
    """

    name: str
    values: tuple[Any, ...]
    cells: tuple[Cell, ...]

    def __post_init__(self) -> None:
        if not self.values:
            raise InputError(f"{self.name}: expected one value or more, got none; name one")
        seen: set[tuple[bool, Cell]] = set()
        for cell in self.cells:
            told = (isinstance(cell, bool), cell)  # True equals 1, and is another cell; 1.0 is not
            if told in seen:
                raise InputError(f"{self.name}: expected each once, got {cell} twice; name it once")
            seen.add(told)


class Grid:
    """All combinations of axes, the last axis fastest, without those that are excluded.

    An exclusion that names an axis which the grid lacks excludes nothing of it.

    Attributes
    ----------
    axes : tuple of Axis
    kept : bool, a dimension an axis
        Which combinations are not excluded.

    Raises `InputError` if there are more combinations than `MOST_RUNS`.
    """

    def __init__(self, axes: Sequence[Axis], exclusions: Exclusions = ()) -> None:
        self.axes = tuple(axes)
        shape = [len(axis.values) for axis in self.axes]
        require_listable(math.prod(shape))
        self.kept: NDArray[np.bool_] = np.ones(shape, dtype=np.bool_)
        names = {axis.name for axis in self.axes}
        for exclusion in exclusions:
            if names.issuperset(exclusion):
                self.kept[np.ix_(*(_matching(axis, exclusion) for axis in self.axes))] = False

    def __len__(self) -> int:
        return int(np.count_nonzero(self.kept))

    def __iter__(self) -> Iterator[tuple[int, ...]]:
        """Yield the position on each axis, combination by combination."""
        shape = self.kept.shape
        kept = np.flatnonzero(self.kept)
        for start in range(0, len(kept), 4096):  # not all at once: there may be millions
            chunk = np.unravel_index(kept[start : start + 4096], shape)
            yield from zip(*(positions.tolist() for positions in chunk), strict=True)

    def middles(self, name: str) -> Iterator[tuple[int, tuple[int, ...]]]:
        """Yield for each value of an axis how many combinations it has, and the middle one."""
        axis = [other.name for other in self.axes].index(name)
        for value in range(self.kept.shape[axis]):
            of_value = np.flatnonzero(np.take(self.kept, [value], axis))
            if len(of_value):
                shape = [1 if at == axis else size for at, size in enumerate(self.kept.shape)]
                of_axes = np.unravel_index(int(of_value[len(of_value) // 2]), shape)
                middle: list[int] = np.array(of_axes).tolist()
                middle[axis] = value
                yield len(of_value), tuple(middle)

    def occupied(self, *names: str) -> Iterator[tuple[Cell, ...]]:
        """Yield the combinations of cells on these axes of which any is left."""
        kept_axes = [at for at, axis in enumerate(self.axes) if axis.name in names]
        others = tuple(at for at in range(len(self.axes)) if at not in kept_axes)
        for positions in np.argwhere(self.kept.any(axis=others)).tolist():
            cells = zip(kept_axes, positions, strict=True)
            yield tuple(self.axes[at].cells[position] for at, position in cells)


def _matching(axis: Axis, exclusion: Mapping[str, Collection[Cell]]) -> NDArray[np.bool_]:
    named = exclusion.get(axis.name, axis.cells)
    return np.array([cell in named for cell in axis.cells], dtype=np.bool_)


def require_listable(count: int) -> None:
    """Raise `InputError` if a study has more runs than can be listed."""
    if count > MOST_RUNS:
        raise InputError(
            f"study: expected at most {MOST_RUNS:,} combinations of its axes, got {count:,}; "
            "take fewer values of some"
        )


def require_known(exclusions: Exclusions, axes: Sequence[Axis]) -> None:
    """Raise `InputError` if an exclusion names an axis or a value that the study lacks."""
    cells: dict[str, list[Cell]] = {}
    for axis in axes:
        cells.setdefault(axis.name, []).extend(axis.cells)
    for exclusion in exclusions:
        if not exclusion:
            raise InputError("exclude: expected an axis and its values, got none; name one")
        for name, values in exclusion.items():
            if name not in cells:
                raise InputError(f"exclude: {unknown_name(name, cells)}")
            for value in values:
                if value not in cells[name]:
                    known = map(str, dict.fromkeys(cells[name]))
                    raise InputError(f"exclude: {name}: {unknown_name(str(value), known)}")
