"""The slow state of a machine: how fast it happens to run, as a function of time."""

from itertools import accumulate
from math import exp, sqrt

import numpy as np

from ...models.machine.residual import Residual

_STEPS = 16  # of the grid in one correlation time: between its points the deviation is 1 % low
_BLOCK = 256


class SlowState:
    """A factor of times that depends on when a frame begins, and on nothing that was drawn before.

    An Ornstein-Uhlenbeck process of unit variance at points of time that do not depend on frames,
    so that under one seed every policy meets the same state at the same time, however many frames
    it took to get there.  The factor ``exp(s · u − s² / 2)`` has the mean 1 and the deviation s,
    and is linear in between.
    """

    def __init__(self, residual: Residual, seed: np.random.SeedSequence) -> None:
        self._scale = residual.slow_scale
        self._per_ns = 1e-9 * _STEPS / residual.slow_time_s
        self._keep = exp(-1.0 / _STEPS)
        self._rng = np.random.default_rng(seed)
        self._state = float(self._rng.standard_normal())  # stationary from the start
        self._first = 0  # number of the grid's point at which the block begins
        self._factors = self._block()

    def at(self, time_ns: int) -> float:
        """Return the factor at a time, which is not before that of an earlier call."""
        place = time_ns * self._per_ns - self._first
        while place >= _BLOCK:
            self._first += _BLOCK
            place -= _BLOCK
            self._factors = self._block()
        left = int(place)
        before = self._factors[left]
        return before + (place - left) * (self._factors[left + 1] - before)

    def _block(self) -> list[float]:
        """Return the factors of the next points, and the one behind them, which the next begins."""
        keep, renew = self._keep, sqrt(1.0 - self._keep**2)
        fresh: list[float] = self._rng.standard_normal(_BLOCK).tolist()
        states = list(accumulate(fresh, lambda u, e: keep * u + renew * e, initial=self._state))
        self._state = states[-1]
        factors = np.exp(self._scale * np.array(states) - 0.5 * self._scale**2)
        return factors.tolist()
