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
        self._times, self._count = times, count

    def __len__(self) -> int:
        """Return the number of completed frames."""
        return self._count

    @property
    def frame(self) -> IntArray:
        """Frame indices, (n,)."""
        return np.arange(self._count, dtype=np.int32)

    @property
    def cpu_ms(self) -> FloatArray:
        """Work times of the CPU, (n,)."""
        return self._column(0)

    @property
    def gpu_ms(self) -> FloatArray:
        """Work times of the GPU, (n,)."""
        return self._column(1)

    @property
    def work_ms(self) -> FloatArray:
        """The larger of the two, (n,)."""
        return self._column(2)

    @property
    def present_ms(self) -> FloatArray:
        """Intervals between displayed frames, (n,)."""
        return self._column(3)

    def last_work_ms(self) -> float:
        """Return the newest work time, or NaN before any frame has completed."""
        return float(self.work_ms[-1]) if self._count else math.nan

    def _column(self, at: int) -> FloatArray:
        column = self._times[: self._count, at]
        column.setflags(write=False)
        return column
