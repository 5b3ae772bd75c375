"""The problem of one frame that policies allocating resolutions solve."""

import math
from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ...solvers.allocation import Shares


@dataclass(frozen=True, slots=True)
class ResolutionProblem:
    """Σ cost · x <= budget over pieces of resolution.

    The first m pieces are the candidates.  A candidate whose cost rises slowly at first, while its
    pixels hide its geometry, and faster from a kink on, has its first stretch as a second piece:
    as the slopes rise, the optimum fills the second piece before it begins the first.

    Attributes
    ----------
    budget_ms : float
        What is left for the pieces; infinite where everything in full is known to fit.
    cost, low, high : (m + e,) float64
        Milliseconds per unit of resolution, and bounds.
    second : (e,) int
        Candidates with a second piece.
    low_ms, high_ms : float
        What the pieces cost at their bounds.
    """

    budget_ms: float
    cost: FloatArray
    low: FloatArray
    high: FloatArray
    second: IntArray
    low_ms: float
    high_ms: float

    def affords_all(self) -> bool:
        """Return whether everything fits in full, whatever it is worth."""
        return self.budget_ms == math.inf or self.high_ms <= self.budget_ms

    def pieces(self, values: FloatArray) -> FloatArray:
        """Return values of candidates for every piece, (m + e,)."""
        return np.concatenate((values, values[self.second])) if len(self.second) else values

    def shares(self, weight: FloatArray, power: float) -> Shares:
        """Return what the pieces share, for the weights of candidates, (m,)."""
        pieces = self.pieces(weight)
        return Shares(pieces, self.cost, self.budget_ms, power, self.low, self.high)

    def resolution(self, x: FloatArray) -> FloatArray:
        """Return the resolution of each candidate from x of each piece, (m,)."""
        if not len(self.second):
            return x
        count = len(x) - len(self.second)
        resolution = x[:count].copy()
        resolution[self.second] += x[count:] - self.low[self.second]
        return resolution
