"""Block bootstrap over the time of a run.

A resample is made of blocks of successive frames, so that the dependence between neighbours stays
in it (Künsch, Annals of Statistics 1989), on a circle, so that every frame is drawn equally often
(Politis and Romano 1992).  A block is a window of the run's time and not of frame numbers: under
another policy the same window shows the same part of the camera's path, whatever the frame rate,
and comparisons are paired.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ..metrics.sample import Sample

BLOCKS = 30
"""Blocks of a resample; a block is this part of the run, such as 2 s of a minute."""

_LARGEST_MATRIX = 2_000_000
"""Frames of all resamples at a time, so that long runs do not exhaust memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Where the blocks of R resamples start.

    Attributes
    ----------
    start : (R, B) float64
        As a share of the run, in [0, 1); every block is 1/B of it.
    """

    start: FloatArray

    def samples(self, time_ns: NDArray[np.int64]) -> Iterator[Sample]:
        """Yield the resamples of n frames, in order, so many at a time as memory is kept for.

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
        first = np.searchsorted(share, self.start).astype(np.int64)
        past = np.searchsorted(share, end).astype(np.int64)
        together = max(_LARGEST_MATRIX // n, 1)
        for at in range(0, len(first), together):
            yield Sample(n, first[at : at + together], past[at : at + together])


def draw_blocks(seed: np.random.SeedSequence, resamples: int) -> Blocks:
    """Return the blocks of a number of resamples."""
    return Blocks(np.random.default_rng(seed).random((resamples, BLOCKS)))
