"""Block bootstrap over the time of a run.

A resample is made of blocks of successive frames, so that the dependence between neighbours stays
in it (Künsch, Annals of Statistics 1989), on a circle, so that every frame is drawn equally often
(Politis and Romano 1992).  A block is a window of the run's time and not of frame numbers: under
another policy the same window shows the same part of the camera's path, whatever the frame rate,
and comparisons are paired.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray

IndexArray: TypeAlias = NDArray[np.intp]

BLOCKS = 30
"""Blocks of a resample; a block is this part of the run, such as 2 s of a minute."""


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Where the blocks of R resamples start.

    Attributes
    ----------
    start : (R, B) float64
        As a share of the run, in [0, 1); every block is 1/B of it.
    """

    start: FloatArray

    def rows(self, time_ns: NDArray[np.int64]) -> IntArray:
        """Return the frames of each resample, (R, m) int32, padded with n.

        Parameters
        ----------
        time_ns : (n,) int64
            Increasing times of the n frames.
        """
        n = len(time_ns)
        elapsed = (time_ns - time_ns[0]).astype(np.float64)
        period = float(elapsed[-1]) * n / (n - 1) if n > 1 else 1.0
        share = np.concatenate((elapsed, elapsed + period)) / period
        end: FloatArray = self.start + 1.0 / self.start.shape[1]
        first: IndexArray = np.searchsorted(share, self.start)
        past: IndexArray = np.searchsorted(share, end)
        count = past - first
        length: IndexArray = count.sum(axis=1)
        rows = np.full((len(first), max(int(length.max()), 1)), n, dtype=np.int32)
        each = count.ravel()
        offset = np.arange(int(each.sum())) - np.repeat(np.cumsum(each) - each, each)
        filled = np.arange(rows.shape[1]) < length[:, np.newaxis]
        rows[filled] = (np.repeat(first.ravel(), each) + offset) % n
        return rows


def draw_blocks(seed: np.random.SeedSequence, resamples: int) -> Blocks:
    """Return the blocks of a number of resamples."""
    return Blocks(np.random.default_rng(seed).random((resamples, BLOCKS)))
