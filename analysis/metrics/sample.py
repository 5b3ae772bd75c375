"""Samples of a run's frames: the run itself, or resamples made of stretches of it.

A resample is never written out frame by frame.  Sums of a stretch are differences of running sums,
and quantiles need only how often each frame is drawn, in the order of the values, which is sorted
once for all resamples.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, IntArray

_KEPT = 4  # series whose order is kept: metrics of one series follow each other


@dataclass(slots=True, eq=False)
class Sample:
    """R samples of n frames, each of B stretches of successive frames on a circle.

    Attributes
    ----------
    frames : int
        Number n of frames of the run.
    first, past : (R, B) int64
        First frame of each stretch, in [0, n], and the one past its last, in [first, 2 n]: frame
        n + i is frame i, one round on.
    """

    frames: int
    first: NDArray[np.int64]
    past: NDArray[np.int64]
    _counts: IntArray | None = field(init=False, repr=False, default=None)
    _ordered: dict[int, tuple[FloatArray, FloatArray, IntArray]] = field(
        init=False, repr=False, default_factory=dict[int, tuple[FloatArray, FloatArray, IntArray]]
    )

    @classmethod
    def whole(cls, frames: int) -> "Sample":
        """Return the sample of every frame once."""
        return cls(frames, np.zeros((1, 1), np.int64), np.full((1, 1), frames, np.int64))

    def sums(self, x: FloatArray | BoolArray) -> FloatArray:
        """Return the sum of a series over each sample, (R,)."""
        if len(self.first) == 1 and self.past[0, 0] - self.first[0, 0] == self.frames:
            return np.array([float(x.sum())])  # pairwise: closer than a running sum
        running = np.zeros(2 * self.frames + 1)
        np.cumsum(np.concatenate((x, x)), out=running[1:])
        totals: FloatArray = (running[self.past] - running[self.first]).sum(axis=1)
        return totals

    def counts(self) -> IntArray:
        """Return how often each frame is drawn, (R, n) int16."""
        if self._counts is not None:
            return self._counts
        samples, n = len(self.first), self.frames
        # Up where a stretch begins and down where it ends; two rounds of the circle are then one.
        steps = np.zeros((samples, 2 * n + 1), dtype=np.int16)
        row = np.repeat(np.arange(samples), self.first.shape[1])
        np.add.at(steps, (row, self.first.ravel()), 1)
        np.subtract.at(steps, (row, self.past.ravel()), 1)
        np.cumsum(steps, axis=1, out=steps)
        self._counts = steps[:, :n] + steps[:, n : 2 * n]
        return self._counts

    def ordered(self, x: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return a series without its NaN in ascending order, (m,), and how often it is drawn.

        The second, (R, m) int32, is how many frames of each sample are among the first 1 to m.
        """
        known = self._ordered.get(id(x))
        if known is None:
            order = np.argsort(x, kind="stable")[: len(x) - int(np.count_nonzero(np.isnan(x)))]
            drawn = np.cumsum(self.counts().take(order, axis=1), axis=1, dtype=np.int32)
            while len(self._ordered) >= _KEPT:
                del self._ordered[next(iter(self._ordered))]
            # The series is kept too, so that no other can have its id meanwhile.
            known = self._ordered[id(x)] = (x, x[order], drawn)
        return known[1:]
