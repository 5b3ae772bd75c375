"""The full grid among the rows of results: what a split of variance needs.

Studies have holes: what is excluded, policies that do not fit a scene, runs that failed.  Over a
grid with holes an axis takes the blame for another, so that values are left out until every
combination of those that stay has every seed.  What was done is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from ....base.errors import InputError
from ..axes.grid import Cell

_SEED, _POLICY = "seed", "policy"

Codes = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class FullGrid:
    """Rows in every combination of some axes.

    Attributes
    ----------
    axes : tuple of str
        Those with two values or more.
    rows : (n_1, ..., n_k, seeds) intp
        Positions of the runs in the table, by the value on each axis and the seed.
    notes : tuple of str
        What is joined and what is left out, a line each.
    """

    axes: tuple[str, ...]
    rows: NDArray[np.intp]
    notes: tuple[str, ...]


def find_full_grid(table: pa.Table, axes: Sequence[str]) -> FullGrid:
    """Return the full grid among the runs of a table that have scores.

    Raises `InputError` if no two values of any axis are left.

    Parameters
    ----------
    axes
        Columns that tell runs apart, `seed` among them; also parameters that some policies lack.
    """
    statuses: list[Any] = table.column("status").to_pylist()
    scored = np.array([at for at, status in enumerate(statuses) if status == "ok"], dtype=np.intp)
    if not len(scored):
        raise InputError("sensitivity: expected runs with scores, got none; choose others")
    columns = {name: table.column(name).take(scored).to_pylist() for name in axes}
    notes: list[str] = []
    _join_parameters(columns, notes)
    codes, cells = _numbered(columns)
    _drop_determined(codes, notes)
    kept = _without_holes(codes, cells, notes)
    varied = [name for name in codes if name != _SEED and len(np.unique(codes[name][kept])) > 1]
    if not varied:
        raise InputError(
            "sensitivity: expected two values of an axis in a full grid of runs, got "
            f"{'none without holes' if notes else 'one of each'}; choose runs with --where"
        )
    places = [np.unique(codes[name][kept], return_inverse=True)[1] for name in (*varied, _SEED)]
    shape = [int(place.max()) + 1 for place in places]
    rows = np.empty(shape, dtype=np.intp)
    rows[tuple(places)] = scored[kept]
    return FullGrid(tuple(varied), rows, tuple(notes))


def _join_parameters(columns: dict[str, list[Any]], notes: list[str]) -> None:
    """Join to the policy the parameters that only some policies have: they are no axis of all."""
    policies = columns[_POLICY]
    joined: list[str] = []
    for name, values in columns.items():
        pairs = {(policy, value is None) for policy, value in zip(policies, values, strict=True)}
        without = {policy for policy, missing in pairs if missing}
        with_it = {policy for policy, missing in pairs if not missing}
        if name != _POLICY and without and with_it and not without & with_it:
            joined.append(name)
    if joined:
        parts = [columns.pop(name) for name in joined]
        columns[_POLICY] = list(zip(policies, *parts, strict=True))
        names = ", ".join(joined)
        notes.append(
            f"policy: with its {names}, which other policies lack; choose one with --where to have "
            f"{names} as axes"
        )


def _numbered(columns: dict[str, list[Any]]) -> tuple[dict[str, Codes], dict[str, list[Cell]]]:
    """Return the number of each row's value on each axis, and the values by number."""
    codes: dict[str, Codes] = {}
    cells: dict[str, list[Cell]] = {}
    for name, values in columns.items():
        cells[name] = list(dict.fromkeys(values))
        numbers = {cell: number for number, cell in enumerate(cells[name])}
        codes[name] = np.array([numbers[value] for value in values], dtype=np.intp)
    return codes, cells


def _drop_determined(codes: dict[str, Codes], notes: list[str]) -> None:
    """Drop axes that follow from another one, as a budget of one refresh does from the display."""
    for name in list(codes):
        others = [other for other in codes if other not in (name, _SEED)]
        if name == _SEED or not codes[name].any():
            continue
        for other in others:
            pairs = np.unique(np.stack((codes[other], codes[name])), axis=1)
            if pairs.shape[1] == len(np.unique(codes[other])):
                del codes[name]
                notes.append(f"{name}: follows from {other}, and is one with it")
                break


def _without_holes(
    codes: dict[str, Codes], cells: dict[str, list[Cell]], notes: list[str]
) -> NDArray[np.bool_]:
    """Return which rows stay when values are left out until no combination is missing."""
    kept = np.ones(len(next(iter(codes.values()))), dtype=np.bool_)
    left_out: dict[str, list[Cell]] = {}
    while kept.any():
        sizes = {name: len(np.unique(numbers[kept])) for name, numbers in codes.items()}
        full = int(np.prod(list(sizes.values())))
        if np.count_nonzero(kept) == full:
            break
        # The value that has the fewest of the runs that it should; of equals the last one.
        _, value, name = min(
            (count * sizes[name] / full, -value, name)
            for name, numbers in codes.items()
            for value, count in enumerate(np.bincount(numbers[kept]).tolist())
            if count
        )
        kept &= codes[name] != -value
        left_out.setdefault(name, []).append(cells[name][-value])
    notes += [
        f"{name}: left out, as runs are missing: {', '.join(map(_shown, sorted(some, key=str)))}"
        for name, some in left_out.items()
    ]
    return kept


def _shown(cell: Any) -> str:
    if isinstance(cell, tuple):  # a policy with its parameters
        parts = cast("tuple[Cell, ...]", cell)
        return " ".join(_shown(part) for part in parts if part is not None)
    return f"{cell:.12g}" if isinstance(cell, float) else str(cell)
