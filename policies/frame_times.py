"""Times of completed frames, as they have reached the CPU."""

import math

import numpy as np

from ..base.arrays import FloatArray, IntArray


class Completed:
    """Measured times of the frames whose measurement has reached the CPU so far, oldest first.

    Attributes
    ----------
    frame : (n,) int64
    cpu_ms, gpu_ms, work_ms : (n,) float64
        Work times as a timer reports them, faults included; work is the larger of the two.
    present_ms : (n,) float64
        Interval to the previous displayed frame, which vsync quantises; NaN if not displayed yet.
    """

    __slots__ = ("_count", "_times")

    def __init__(self, times: FloatArray, count: int) -> None:
        """Wrap the first `count` rows of (n, 4) times: cpu, gpu, work, present."""
        self._times = times.view()
        self._times.flags.writeable = False
        self._count = count

    def __len__(self) -> int:
        """Return the number of completed frames."""
        return self._count

    @property
    def frame(self) -> IntArray:
        """Frame indices, (n,)."""
        return np.arange(self._count, dtype=np.int32)

    @property
    def cpu_ms(self) -> FloatArray:
        """CPU time of each frame."""
        return self._times[: self._count, 0]

    @property
    def gpu_ms(self) -> FloatArray:
        """GPU time of each frame."""
        return self._times[: self._count, 1]

    @property
    def work_ms(self) -> FloatArray:
        """Larger of CPU and GPU time of each frame."""
        return self._times[: self._count, 2]

    @property
    def present_ms(self) -> FloatArray:
        """Interval between presents that each frame ended."""
        return self._times[: self._count, 3]

    def last_work_ms(self) -> float:
        """Return the newest work time, or NaN before any frame has completed."""
        return float(self._times[self._count - 1, 2]) if self._count else math.nan
