"""Foliage whose leaves collapse in pairs and keep the area that they cover."""

from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np

from ...base.arrays import FloatArray, IntArray, freeze
from ...base.errors import InputError, require_between

_NEIGHBOURS = 6
_SHARE_OF_ROUND = 0.25  # of the leaves, at most; then neighbours are looked for anew


@dataclass(frozen=True, slots=True)
class Leaves:
    """N rectangles, ``center ± along ± across``, two triangles each; (N, 3) float64 in metres."""

    center_m: Annotated[FloatArray, np.float64, "N", 3]
    along_m: Annotated[FloatArray, np.float64, "N", 3]
    across_m: Annotated[FloatArray, np.float64, "N", 3]

    def __post_init__(self) -> None:
        freeze(self, "leaf", N=len(self))
        if len(self) == 0 or not (self.area_m2 > 0.0).all():
            raise InputError("leaves: expected at least one, each with an area")

    def __len__(self) -> int:
        """Return the number of leaves."""
        return len(self.center_m)

    @property
    def area_m2(self) -> FloatArray:
        """Area of each leaf, one side, (N,)."""
        return 4.0 * np.linalg.norm(np.cross(self.along_m, self.across_m), axis=1)

    def at(self, rows: IntArray) -> "Leaves":
        """Return some of the leaves."""
        return Leaves(self.center_m[rows], self.along_m[rows], self.across_m[rows])


@dataclass(frozen=True, slots=True)
class Foliage:
    """N leaves and the S collapses that each replace two leaves by one.

    Source: Remolar, Chover, Belmonte, Ribelles and Rebollo, "Geometric simplification of foliage"
    (2002), and the LodTrees that Gumbau, Ripolles and Chover name (LODManager, section 5.2).

    Attributes
    ----------
    leaves : Leaves
        N + S, the ones that replace others last.
    died : (N + S,) int32
        Step that replaces each leaf, S if none does; leaf N + i is born in step i.
    """

    leaves: Leaves
    died: Annotated[IntArray, np.int32, "N"]

    def __post_init__(self) -> None:
        freeze(self, "foliage", N=len(self.leaves))

    @property
    def steps(self) -> int:
        """Collapses in all."""
        return int(self.died.max())

    @property
    def full(self) -> int:
        """Leaves at full resolution."""
        return len(self.leaves) - self.steps

    def extract(self, count: int) -> IntArray:
        """Return the rows of the leaves drawn at exactly this count.

        Raises `InputError` if the count is not between the fewest and all leaves.
        """
        least = self.full - self.steps
        require_between(count, least, self.full, "leaves")
        # Every step puts one leaf in the place of two, so it takes one off the count.
        step = self.full - count
        born = np.arange(len(self.died)) - self.full
        return np.flatnonzero((born < step) & (self.died >= step)).astype(np.int32)


def collapse_leaves(leaves: Leaves, *, least: int = 1) -> Foliage:
    """Collapse pairs of leaves, the most alike first, down to `least`.

    Pairs are alike that are near and parallel.  In rounds, the nearest neighbours of every leaf are
    paired greedily by cost, so that a leaf collapses once a round; a round ends after a quarter of
    the leaves.  The new leaf has the area of both, their common centre of area, and the principal
    axes of both.
    """
    require_between(least, 1, len(leaves), "least")
    # Each of the N - least collapses makes one leaf: 2 N - least rows in all.
    parts, died, alive = [leaves], np.full(2 * len(leaves) - least, -1), np.arange(len(leaves))
    step = 0
    everything = leaves
    while len(alive) > least:
        # A pair takes one leaf off the count: no more pairs than leaves too many.
        pairs = _pairs(everything.at(alive))[: len(alive) - least]
        merged = _merge(everything.at(alive[pairs[:, 0]]), everything.at(alive[pairs[:, 1]]))
        when = step + np.arange(len(pairs))
        died[alive[pairs]] = when[:, None]
        parts.append(merged)
        alive = np.append(np.delete(alive, pairs.ravel()), len(leaves) + when)
        everything = _join(parts)
        step += len(pairs)
    died[died < 0] = step
    return Foliage(everything, died)


def leaf_triangles(leaves: Leaves) -> tuple[FloatArray, IntArray]:
    """Return the four corners of each leaf, (4 N, 3), and its two triangles, (2 N, 3)."""
    c, u, v = leaves.center_m, leaves.along_m, leaves.across_m
    corners = np.stack((c - u - v, c + u - v, c + u + v, c - u + v), axis=1).reshape(-1, 3)
    base = 4 * np.arange(len(leaves))[:, None, None]
    triangles = base + np.array(((0, 1, 2), (0, 2, 3)))
    return corners, triangles.reshape(-1, 3).astype(np.int32)


def _join(parts: list[Leaves]) -> Leaves:
    return Leaves(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Leaves)))


def _pairs(leaves: Leaves) -> IntArray:
    """Return disjoint pairs of near leaves, cheapest first, (n, 2)."""
    from scipy.spatial import KDTree

    # One more than wanted, as every leaf is its own nearest neighbour.
    count = min(_NEIGHBOURS + 1, len(leaves))
    near = np.asarray(KDTree(leaves.center_m).query(leaves.center_m, k=count)[1])
    first = np.repeat(np.arange(len(leaves)), count)
    # Pairs come from both their ends; sorted, each is kept once.
    pairs = np.sort(np.stack((first, near.ravel()), axis=1), axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    order = np.argsort(_cost(leaves, pairs), kind="stable")
    free = np.ones(len(leaves), dtype=np.bool_)
    most = max(1, int(_SHARE_OF_ROUND * len(leaves)))
    chosen: list[int] = []
    for row, (a, b) in zip(order.tolist(), pairs[order].tolist(), strict=True):
        if free[a] and free[b]:
            free[a] = free[b] = False
            chosen.append(row)
            if len(chosen) == most:
                break
    return pairs[chosen]


def _cost(leaves: Leaves, pairs: IntArray) -> FloatArray:
    """Return the second moment of area that joining two leaves adds, in m⁴, as if turned alike."""
    area, normal = leaves.area_m2, np.cross(leaves.along_m, leaves.across_m)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    a, b = pairs.T
    # Steiner's theorem: about the common centre, two areas have A · B / (A + B) · d² more than
    # each has about its own.
    apart = ((leaves.center_m[a] - leaves.center_m[b]) ** 2).sum(axis=1)
    skew = 1.0 - np.einsum("ij,ij->i", normal[a], normal[b]) ** 2
    # Turning the smaller leaf into the other's plane moves it by its own extent: the second moment
    # of a square of that area, A² / 12.
    smaller = np.minimum(area[a], area[b])
    return area[a] * area[b] / (area[a] + area[b]) * apart + skew * smaller**2 / 12.0


def _merge(a: Leaves, b: Leaves) -> Leaves:
    """Return the leaf that replaces each pair."""
    shares = np.stack((a.area_m2, b.area_m2))
    area = shares.sum(axis=0)
    shares /= area
    center = shares[0, :, None] * a.center_m + shares[1, :, None] * b.center_m
    moment = np.zeros((len(area), 3, 3))
    for share, leaf in zip(shares, (a, b), strict=True):
        offset = leaf.center_m - center
        # A uniform stretch from -u to u has second moment u² / 3; the offset counts in full.
        for weight, rows in ((1.0 / 3.0, leaf.along_m), (1.0 / 3.0, leaf.across_m), (1.0, offset)):
            moment += (weight * share)[:, None, None] * rows[:, :, None] * rows[:, None, :]
    # Ascending: the last two axes span the plane of the new leaf, the first is its normal.
    values, axes = np.linalg.eigh(moment)
    long, short = np.sqrt(values[:, 2]), np.sqrt(values[:, 1])
    # 4 · long · short · scale² is the area of both: what leaves cover is kept.
    scale = np.sqrt(area / (4.0 * long * short))
    return Leaves(
        center, axes[:, :, 2] * (scale * long)[:, None], axes[:, :, 1] * (scale * short)[:, None]
    )
