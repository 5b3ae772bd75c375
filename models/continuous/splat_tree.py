"""Splat trees: a plant's leaves as a k-d tree, drawn within a budget of splats."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray, frozen_array, require_finite
from ...base.errors import InputError
from ..scene.levels import LevelTable, count_rows

_SPLAT_BYTES = 16.0  # position and radius, float32


@dataclass(frozen=True, slots=True)
class Splats:
    """M splats that stand for all leaves.

    Attributes
    ----------
    center_m : (M, 3) float64
    radius_m : (M,) float64
        Of a disc of the area of the leaves that the splat stands for.
    start : (M + 1,) int64
        Splat i stands for leaves `start[i]` to `start[i + 1]` in the order of the tree.
    """

    center_m: FloatArray
    radius_m: FloatArray
    start: IntArray


@dataclass(frozen=True, slots=True)
class SplatTree:
    """N leaves in the order of a k-d tree, split at the median of the longest axis.

    Halves differ by one leaf at most, the second being the larger, so that the tree is known from
    the order alone, and sums over any node are differences of running sums.

    Source: Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous levels of
    detail" (2002), sections 5.1 and 5.2.  Difference: the view direction spends no budget.

    Attributes
    ----------
    position_m : (N, 3) float64
    area_m2 : (N,) float64
    """

    position_m: FloatArray
    area_m2: FloatArray

    @classmethod
    def of(cls, position_m: FloatArray, area_m2: FloatArray) -> "SplatTree":
        """Sort leaves into a tree.

        Raises `InputError` if there is no leaf, a position is not finite, or an area is not above
        0.
        """
        n = len(position_m)
        if n == 0:
            raise InputError("splat tree: expected at least one leaf, got none")
        position = frozen_array(position_m, np.float64, (n, 3), "leaf position_m")
        area = frozen_array(area_m2, np.float64, (n,), "leaf area_m2")
        require_finite(position, "leaf position_m")
        require_finite(area, "leaf area_m2", low=np.finfo(float).tiny)
        order, size, start = np.arange(n), np.array([n]), np.array([0])
        while size.max() > 1:
            # All nodes of one depth at a time: each is a range of `order`.
            low = np.minimum.reduceat(position[order], start)
            high = np.maximum.reduceat(position[order], start)
            axis = np.repeat((high - low).argmax(axis=1), size)
            # By node first, then along its longest axis, so that ranges stay where they are.
            order = order[
                np.lexsort((position[order, axis], np.repeat(np.arange(len(size)), size)))
            ]
            size = np.stack((size // 2, size - size // 2), axis=1).ravel()
            # A node of one leaf splits into nothing and itself.
            size = size[size > 0]
            start = np.cumsum(size) - size
        return cls(position[order], area[order])

    def __len__(self) -> int:
        """Return the number of leaves."""
        return len(self.position_m)

    def draw(self, budget: int) -> Splats:
        """Return the splats of a traversal with a budget; exactly so many, up to one a leaf.

        At each node the budget is divided between the branches; a node that gets no more than one
        splat is drawn as one.
        """
        if budget < 1:
            raise InputError(f"budget: expected at least one splat, got {budget}")
        start, size, left = (np.array([value]) for value in (0, len(self), budget))
        done: list[IntArray] = []
        while len(start):
            ends = (left < 2) | (size < 2)
            done.append(start[ends])
            start, size, left = (values[~ends] for values in (start, size, left))
            half = size // 2
            start = np.concatenate((start, start + half))
            size = np.concatenate((half, size - half))
            # Halves of two or more are at least one, so that every leaf gets a splat.  The larger
            # half of the budget goes with the larger half of the leaves.
            left = np.concatenate((left // 2, left - left // 2))
        return self._splats(np.sort(np.concatenate(done)))

    def error_m(self, splats: Splats) -> float:
        """Return the greatest distance of a leaf from the centre of its splat."""
        owner = np.repeat(np.arange(len(splats.center_m)), np.diff(splats.start))
        return float(np.linalg.norm(self.position_m - splats.center_m[owner], axis=1).max())

    def _splats(self, start: IntArray) -> Splats:
        area = np.add.reduceat(self.area_m2, start)
        moment = np.add.reduceat(self.area_m2[:, None] * self.position_m, start)
        bounds = np.append(start, len(self))
        alone = np.diff(bounds)[:, None] == 1
        # A mean over one leaf would round its position.
        center = np.where(alone, self.position_m[start], moment / area[:, None])
        return Splats(center, np.sqrt(area / np.pi), bounds)


def splat_levels(tree: SplatTree, *, knots: int = 12, trees: int = 1) -> LevelTable:
    """Return the continuous type of a group of equal splat trees, one draw call a tree.

    Knots are geometrically spaced from a splat a leaf to a splat a tree; errors are measured, and
    raised to that of the finer knot where they are below.  Below a splat a tree "only the
    corresponding fraction of the group is rendered" (section 5.4): the last knot of a group is one
    tree of one splat, at the error of a tree that is not there, its size.

    Raises `InputError` if there are fewer than two knots, or no tree.
    """
    if knots < 2 or trees < 1:
        raise InputError(f"expected at least 2 knots and 1 tree, got {knots} and {trees}")
    budgets = np.unique(np.geomspace(1, len(tree), knots).round().astype(np.int64))[::-1]
    drawn, splats = np.full(len(budgets), trees), trees * budgets
    errors = [tree.error_m(tree.draw(int(budget))) for budget in budgets]
    sizes = _SPLAT_BYTES * budgets.astype(np.float64)
    if trees > 1:
        drawn, splats = np.append(drawn, 1), np.append(splats, 1)
        errors.append(float(np.linalg.norm(np.ptp(tree.position_m, axis=0))))
        sizes = np.append(sizes, sizes[-1])
    return LevelTable(
        np.array([0, len(splats)]),
        count_rows(len(splats), draw_calls=drawn, splats=splats),
        np.maximum.accumulate(errors),
        sizes,
        np.array([True]),
    )
