"""Random placement of discs without overlap."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError

Propose: TypeAlias = Callable[[int], FloatArray]
"""Draws n candidate centres, (n, 2)."""

_ROUNDS = 2_000


def default_side_m(radius_m: FloatArray, coverage: float) -> float:
    """Return the side of a square of which the discs cover a share, and that holds the largest."""
    return max(float(np.sqrt(np.pi * (radius_m**2).sum() / coverage)), 2.0 * float(radius_m.max()))


def require_side(side_m: float, needed_m: float, count: int, layout: str) -> None:
    """Raise InputError where a square is smaller than a layout needs."""
    if side_m < needed_m:
        raise InputError(
            f"layout {layout}: expected a side of at least {needed_m:.1f} m for {count} objects "
            f"with their spacing, got {side_m:g} m; widen the side, or lower the count, the "
            "spacing or the height of the types"
        )


def pack_discs(radius_m: FloatArray, side_m: float, propose: Propose, layout: str) -> FloatArray:
    """Return centres (N, 2) in a square about the origin, such that no two discs overlap.

    Random sequential adsorption in rounds: every disc that is left gets one candidate, and keeps
    it unless it meets a placed disc or an earlier candidate.  Discs go in by size class, the
    largest first, so that the neighbours of a candidate stay few however sizes differ.

    Raises `InputError` if discs are left after many rounds.
    """
    centers = np.empty((len(radius_m), 2))
    size_class = np.floor(np.log2(radius_m.max() / radius_m))
    placed: list[tuple[Any, FloatArray]] = []
    for number in np.unique(size_class):
        left = members = np.flatnonzero(size_class == number)
        own, rounds = left[:0], 0
        while len(left):
            if (rounds := rounds + 1) > _ROUNDS:
                raise InputError(
                    f"layout {layout}: expected room for {len(radius_m)} objects, got none for the "
                    f"last {len(left)} of a size; widen the side or lower the count"
                )
            xy, radius = propose(len(left)), radius_m[left]
            free = (np.abs(xy).max(axis=1) + radius) <= side_m / 2.0
            for tree, others in (*placed, (_tree(centers[own]), radius_m[own])):
                free &= ~_touched(xy, radius, tree, others)
            free &= ~_touched_by_earlier(xy, radius, free)
            centers[left[free]] = xy[free]
            own, left = np.concatenate((own, left[free])), left[~free]
        placed.append((_tree(centers[members]), radius_m[members]))
    return centers


def _tree(points: FloatArray) -> Any:
    from scipy.spatial import KDTree

    return KDTree(points)


def _touched(xy: FloatArray, radius: FloatArray, tree: Any, others: FloatArray) -> BoolArray:
    """Return which discs meet any disc of a tree, (m,)."""
    touched = np.zeros(len(xy), dtype=np.bool_)
    if len(others):
        reach = float(radius.max() + others.max())
        pairs: Any = _tree(xy).sparse_distance_matrix(tree, reach, output_type="ndarray")
        meet = pairs["v"] < radius[pairs["i"]] + others[pairs["j"]]
        touched[pairs["i"][meet]] = True
    return touched


def _touched_by_earlier(xy: FloatArray, radius: FloatArray, free: BoolArray) -> BoolArray:
    """Return which discs meet a free disc that stands before them in the order, (m,)."""
    pairs = np.asarray(_tree(xy).query_pairs(2.0 * float(radius.max()), output_type="ndarray"))
    touched = np.zeros(len(xy), dtype=np.bool_)
    first, second = pairs[:, 0], pairs[:, 1]
    gap = np.linalg.norm(xy[first] - xy[second], axis=1) - radius[first] - radius[second]
    touched[second[(gap < 0) & free[first]]] = True
    return touched
