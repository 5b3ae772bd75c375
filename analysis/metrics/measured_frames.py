"""The measured frames of a log, after its warm-up, and the series that several metrics share."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError
from ...sim.frame_log import FrameLog, LogHeader

MS_PER_NS = 1e-6


class MeasuredFrames:
    """Frames of one replay from the end of its warm-up on.

    Every series has a value for each measured frame, NaN where the frame has none.  Differences
    from the frame before are taken before the warm-up is cut off, so that the first measured frame
    has them too.

    Attributes
    ----------
    log : FrameLog
    warmup : int
        Frames cut off.
    """

    def __init__(self, log: FrameLog, warmup: int = 0) -> None:
        if not 0 <= warmup < len(log):
            raise InputError(
                f"warm-up: expected fewer frames than the {len(log)} of the run, got {warmup}; "
                "lower --warmup or replay more frames"
            )
        self.log = log
        self.warmup = warmup

    def __len__(self) -> int:
        """Return the number of measured frames."""
        return len(self.log) - self.warmup

    def __getitem__(self, column: str) -> FloatArray:
        """Return a count of the frame log, (n,)."""
        return self.log[column][self.warmup :]

    @property
    def header(self) -> LogHeader:
        """What was replayed."""
        return self.log.header

    @cached_property
    def input_ns(self) -> NDArray[np.int64]:
        """Simulated time at which each frame sampled the camera."""
        return self.log["input_ns"][self.warmup :]

    @cached_property
    def time_s(self) -> FloatArray:
        """`input_ns` in seconds."""
        return np.multiply(self.input_ns, 1e-9, dtype=np.float64)

    @cached_property
    def work_ms(self) -> FloatArray:
        """Larger of CPU and GPU time: what a budget limits, never quantised."""
        return np.maximum(self["cpu_ms"], self["gpu_ms"])

    @cached_property
    def frame_ms(self) -> FloatArray:
        """Interval since the display of the frame shown before; NaN for frames never shown."""
        return self._since_shown(self.log["display_ns"])[self.warmup :]

    @cached_property
    def lag_ms(self) -> FloatArray:
        """Display minus input sample; NaN for frames never shown."""
        lag = (self.log["display_ns"] - self.log["input_ns"]) * MS_PER_NS
        return np.where(self._shown, lag, np.nan)[self.warmup :]

    @cached_property
    def animation_error_ms(self) -> FloatArray:
        """Step of the simulated world minus step on the screen, signed."""
        world = self._since_shown(self.log["input_ns"])
        screen = self._since_shown(self.log["display_ns"])
        return (world - screen)[self.warmup :]

    @cached_property
    def previous_frame_ms(self) -> FloatArray:
        """`frame_ms` of the frame shown before; NaN for frames never shown."""
        every = self._since_shown(self.log["display_ns"])
        before = np.full(len(every), np.nan)
        shown = np.flatnonzero(self._shown)
        before[shown[1:]] = every[shown[:-1]]
        return before[self.warmup :]

    @property
    def _shown(self) -> BoolArray:
        return self.log["display_ns"] >= 0

    def _since_shown(self, time_ns: NDArray[np.int64]) -> FloatArray:
        shown = np.flatnonzero(self._shown)
        since = np.full(len(self.log), np.nan)
        since[shown[1:]] = np.diff(time_ns[shown]) * MS_PER_NS
        return since
