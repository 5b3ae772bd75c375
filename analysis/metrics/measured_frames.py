"""The measured frames of a log: those of one window of the path, and what each of them weighs.

The clock is the path's.  Were frames the clock, a policy that is slow in one place would have few
frames there, and its mean would hide what a viewer waits for.  A frame's picture weighs by the time
that it is on the screen, its cost by the time that the screen waited for it.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError
from ...sim.frame_log import FrameLog, LogHeader

MS_PER_NS = 1e-6


class MeasuredFrames:
    """Frames of one replay whose input sample lies in a window of the path.

    Every series has a value for each measured frame, NaN where the frame has none.  Differences
    from frames before the window are taken, so that the first measured frame has them too.

    Raises `InputError` if the window is empty, or no frame lies in it.

    Attributes
    ----------
    log : FrameLog
    warmup_s, end_s : float
        The window, by the path's clock.
    """

    def __init__(self, log: FrameLog, warmup_s: float = 0.0, end_s: float | None = None) -> None:
        input_ns = log["input_ns"]
        if end_s is None:  # what is on the screen at the end is not known
            end_s = float(max(log["display_ns"].max(initial=0), input_ns.max(initial=0))) * 1e-9
        require_window(warmup_s, end_s)
        self.log, self.warmup_s, self.end_s = log, warmup_s, end_s
        self._start_ns, self._end_ns = round(warmup_s * 1e9), round(end_s * 1e9)
        first = int(np.searchsorted(input_ns, self._start_ns))
        past = int(np.searchsorted(input_ns, self._end_ns, side="right"))
        if first >= past:
            raise InputError(
                f"window: expected a frame that begins in {warmup_s:g} to {end_s:g} s of the path, "
                f"got none of {len(log)}; take a shorter warm-up, or a longer path"
            )
        self._rows = slice(first, past)

    def __len__(self) -> int:
        """Return the number of measured frames."""
        return self._rows.stop - self._rows.start

    def __getitem__(self, column: str) -> FloatArray:
        """Return a count of the frame log, (n,)."""
        return self.log[column][self._rows]

    @property
    def header(self) -> LogHeader:
        """What was replayed."""
        return self.log.header

    @property
    def first(self) -> int:
        """Which frame of the log is the first measured one."""
        return self._rows.start

    @property
    def window_s(self) -> float:
        """How long the window is."""
        return self.end_s - self.warmup_s

    @cached_property
    def input_ns(self) -> NDArray[np.int64]:
        """Simulated time at which each frame sampled the camera."""
        return self.log["input_ns"][self._rows]

    @cached_property
    def time_s(self) -> FloatArray:
        """`input_ns` in seconds."""
        return np.multiply(self.input_ns, 1e-9, dtype=np.float64)

    @cached_property
    def picture_weight_ms(self) -> FloatArray:
        """Time in the window for which each frame is on the screen; 0 if it is never shown.

        The last frame stays to the end of the window, and no frame longer.
        """
        weight = np.zeros(len(self.log))
        display_ns = self.log["display_ns"][self._all_shown]
        weight[self._all_shown] = self._time_in_window(display_ns, np.append(display_ns[1:], _LAST))
        return weight[self._rows]

    @cached_property
    def cost_weight_ms(self) -> FloatArray:
        """Time in the window for which the screen waited for each frame.

        Frames that are never shown share that of the next one shown equally with it.
        """
        weight = np.zeros(len(self.log))
        shown = self._all_shown
        display_ns = self.log["display_ns"][shown]
        if not len(shown):
            return weight[self._rows]
        # The first frame of a replay is waited for from its input sample on.
        since_ns = np.concatenate((self.log["input_ns"][:1], display_ns[:-1]))
        together = np.diff(shown, prepend=-1)
        share = self._time_in_window(since_ns, display_ns) / together
        weight[: shown[-1] + 1] = np.repeat(share, together)
        return weight[self._rows]

    def _time_in_window(
        self, from_ns: NDArray[np.int64], until_ns: NDArray[np.int64]
    ) -> FloatArray:
        """Return how much of each interval lies in the window, in ms."""
        clipped = np.minimum(until_ns, self._end_ns) - np.maximum(from_ns, self._start_ns)
        return np.maximum(clipped, 0) * MS_PER_NS

    @cached_property
    def work_ms(self) -> FloatArray:
        """Larger of CPU and GPU time: what a budget limits, never quantised."""
        return np.maximum(self["cpu_ms"], self["gpu_ms"])

    @cached_property
    def frame_ms(self) -> FloatArray:
        """Interval since the display of the frame shown before; NaN for frames never shown."""
        return self._since_shown(self.log["display_ns"])[self._rows]

    @cached_property
    def lag_ms(self) -> FloatArray:
        """Display minus input sample; NaN for frames never shown."""
        lag = (self.log["display_ns"] - self.log["input_ns"]) * MS_PER_NS
        return np.where(self.shown, lag[self._rows], np.nan)

    @cached_property
    def animation_error_ms(self) -> FloatArray:
        """Step of the simulated world minus step on the screen, signed."""
        world = self._since_shown(self.log["input_ns"])
        screen = self._since_shown(self.log["display_ns"])
        return (world - screen)[self._rows]

    @cached_property
    def previous_frame_ms(self) -> FloatArray:
        """`frame_ms` of the frame shown before; NaN for frames never shown."""
        every = self._since_shown(self.log["display_ns"])
        before = np.full(len(every), np.nan)
        shown = self._all_shown
        before[shown[1:]] = every[shown[:-1]]
        return before[self._rows]

    @cached_property
    def shown(self) -> BoolArray:
        """Which frames came to the screen."""
        return self.log["display_ns"][self._rows] >= 0

    @cached_property
    def _all_shown(self) -> NDArray[np.intp]:
        return np.flatnonzero(self.log["display_ns"] >= 0)

    def _since_shown(self, time_ns: NDArray[np.int64]) -> FloatArray:
        shown = self._all_shown
        since = np.full(len(self.log), np.nan)
        since[shown[1:]] = np.diff(time_ns[shown]) * MS_PER_NS
        return since


def require_window(warmup_s: float, end_s: float) -> None:
    """Raise `InputError` unless a warm-up of the path leaves some of it to be measured."""
    if not 0.0 <= warmup_s < end_s:
        raise InputError(
            f"warmup: expected seconds >= 0 and less than the path's {end_s:g}, got {warmup_s:g}; "
            "take a shorter warm-up, or a longer path"
        )


_LAST = np.iinfo(np.int64).max
