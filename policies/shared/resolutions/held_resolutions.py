"""Resolutions that resist change: hysteresis in the allocation of resolutions.

Degradation counts ``1 + h`` times where a resolution falls below the last frame's and ``1 - h``
times where it rises above, so that it stays where neither is worth while.  The sum stays convex
with a kink at the last resolution, and so an object is two pieces of `ResolutionProblem`'s kind:
one up to there and one beyond, of which the first is always filled before the second begins.
"""

from dataclasses import replace

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ...solvers.allocation import Shares
from .resolution_problem import ResolutionProblem


class HeldResolutions:
    """The last frame's resolution of each node."""

    def __init__(self, nodes: int, hysteresis: float) -> None:
        """Take h, in [0, 1); with 0 nothing is held."""
        self._hysteresis = hysteresis
        self._last = np.zeros(nodes)  # 0 stands for none
        self._split: IntArray = np.zeros(0, dtype=np.intp)
        self._at = np.zeros(0)

    def shares(
        self, problem: ResolutionProblem, ids: IntArray, weight: FloatArray, power: float
    ) -> Shares:
        """Return what the pieces share, as `ResolutionProblem.shares`, those of kinks last."""
        plain = problem.shares(weight, power)
        if not self._hysteresis:
            return plain
        n, last = len(ids), self._last[ids]
        low, high = plain.low[:n], plain.high[:n]
        self._split = np.flatnonzero((last > low) & (last < high))
        self._at = last[self._split]
        factor = np.ones(len(plain.weight))
        falls = 1.0 + self._hysteresis
        factor[:n] = np.where(last > low, falls, np.where(last > 0.0, 2.0 - falls, 1.0))
        cost = plain.cost[self._split]
        top = plain.high.copy()
        top[self._split] = self._at
        return replace(
            plain,
            weight=np.append(plain.weight * factor, plain.weight[self._split] * (2.0 - falls)),
            cost=np.append(plain.cost, cost),
            budget=plain.budget + float(cost @ self._at),
            low=np.append(plain.low, self._at),
            high=np.append(top, high[self._split]),
        )

    def resolution(self, problem: ResolutionProblem, x: FloatArray) -> FloatArray:
        """Return the resolution of each candidate from x of each piece of the last `shares`."""
        if not self._hysteresis:
            return problem.resolution(x)
        pieces, beyond = np.split(x, [len(problem.cost)])
        pieces[self._split] += beyond - self._at
        return problem.resolution(pieces)

    def keep(self, ids: IntArray, resolution: FloatArray) -> None:
        """Take a frame's resolutions; nodes that are not among them have none any more."""
        if self._hysteresis:
            self._last.fill(0.0)
            self._last[ids] = resolution
