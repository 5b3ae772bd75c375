"""Increments of a hierarchy of discrete representations, by falling benefit per cost.

This work is based on: Mason and Blake, "Automatic hierarchical level of detail optimization in
computer animation", Computer Graphics Forum 16(3), 1997, as Zach, Mantler and Karner (VRST 2002,
section 2.1.1) restate it: of the increments that are possible and still fit, the one with the most
benefit per cost is taken, again and again, from the coarsest representation on.

Taking one at a time, a good increment behind a poor one waits for it.  So the order is known in
advance: by the least benefit per cost met on the way to an increment; increments are taken in bulk.
Of several that waited for the same one, those higher up come first, whatever their own slopes.
"""

import math
from itertools import pairwise

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray

SAME_SLOPE = 1.0 - 1e-9
"""Slopes within this factor are equal: a line search meets its target only so far."""


class IncrementForest:
    """Increments of m rows of up to W each.

    An increment needs the one before it in its row, and the first of a row the last of the row
    `above` it.  `taken` is (m, W).
    """

    def __init__(
        self, cost: FloatArray, gain: FloatArray, void: BoolArray, above: IntArray, layers: IntArray
    ) -> None:
        """Find the order of all increments.

        Parameters
        ----------
        cost, gain : (m, W) float64
            What each increment adds; one that gains nothing is never taken.
        void : (m, W) bool
            Places without an increment.
        above : (m,) int
            Row above, in an earlier layer; -1 for none.
        layers : (D + 1,) int
            First row of each layer, and m.
        """
        self._above, self._layers = above, layers
        self.taken = np.zeros(cost.shape, dtype=np.bool_)
        self._matrix = np.where(void, 0.0, cost)
        ratio = np.divide(gain, cost, out=np.full(cost.shape, math.inf), where=cost > 0.0)
        ratio[gain <= 0.0] = -math.inf
        # Neutral to the running minimum: what comes behind a void does not wait for it.
        ratio[void] = math.inf
        # A row begins at the least ratio of the row above it, which an earlier layer has settled.
        for rows in self._blocks():
            before = np.where(above[rows] >= 0, ratio[above[rows], -1], math.inf)
            ratio[rows, 0] = np.minimum(ratio[rows, 0], before)
            np.minimum.accumulate(ratio[rows], axis=1, out=ratio[rows])
        possible = np.flatnonzero((ratio > 0.0) & ~void)
        key = ratio.ravel()[possible]
        # Stable: of equal keys the one above stands first.
        order = np.argsort(-key, kind="stable")
        self._rest, self._key = possible[order], key[order]
        self._cost = cost.ravel()[self._rest]
        self.count = len(order)

    def _blocks(self) -> list[slice]:
        starts: list[int] = self._layers.tolist()
        return [slice(*ends) for ends in pairwise(starts)]

    def slope(self, left: float) -> float:
        """Return benefit per cost of the best increment that costs at most `left`; 0 if none."""
        # A pass over all rows, so only when the increment that is next does not fit.
        if len(self._rest) and self._cost[0] > left:
            self._drop(left)
        return float(self._key[0]) if len(self._rest) else 0.0

    def take(self, slope: float, left: float) -> float:
        """Take increments in order down to `slope` while they fit; return what they cost."""
        wanted = int(np.searchsorted(-self._key, -slope * SAME_SLOPE, side="right"))
        # In order, what an increment needs stands before it: any prefix is a valid selection.
        total = np.cumsum(self._cost[:wanted])
        over = total > left
        count = int(over.argmax()) if over.any() else wanted
        self.taken.ravel()[self._rest[:count]] = True
        self._keep(slice(count, None))
        return float(total[count - 1]) if count else 0.0

    def ahead(self, left: float) -> tuple[float, float]:
        """Return a slope to which smooth variables may be raised, and what that may cost.

        Increments that together cost at most half of what is left will all fit, whatever the
        smooth variables do with the other half: these may pass them, with the same end as if they
        had taken turns.  Otherwise only the next increment counts.
        """
        if not len(self._rest):
            return 0.0, left
        over = np.cumsum(self._cost) > 0.5 * left
        count = int(over.argmax()) if over.any() else len(over)
        if count < 2:
            return float(self._key[0]), left
        return float(self._key[count - 1]), 0.5 * left

    def _drop(self, left: float) -> None:
        """Drop increments that do not fit any more, and those that need them."""
        # What is left only shrinks, so what does not fit now never will.
        dead = (self._matrix > left) & ~self.taken
        for rows in self._blocks():
            above = self._above[rows]
            dead[rows, 0] |= (above >= 0) & dead[above, -1]
            # Column by column: `accumulate` along so short an axis takes several times as long.
            for column in range(1, dead.shape[1]):
                dead[rows, column] |= dead[rows, column - 1]
        self._keep(np.flatnonzero(~dead.ravel()[self._rest]))

    def _keep(self, which: slice | IntArray) -> None:
        self._rest, self._key = self._rest[which], self._key[which]
        self._cost = self._cost[which]
