"""Pacing: how long a frame that could begin waits before it samples its input.

A frame that begins as soon as the CPU is free waits in queues afterwards, with a camera that grows
old.  To wait before the sample costs nothing that a screen would show.
"""

from bisect import bisect_left, insort
from collections import deque
from math import ceil
from typing import Protocol

from ...models.machine.hardware import Display

HISTORY_FRAMES = 60
"""Completed frames from which the next one's work is expected: as many as Chromium's compositor
keeps (cc/scheduler/compositor_timing_history.cc)."""

SAFETY_NS = 1_000_000
"""Left between the expected end of a frame and its refresh: Chromium's deadline fudge factor."""

_NS_PER_S = 1_000_000_000


class Pacer(Protocol):
    """What the pipeline asks of pacing, and tells it."""

    def start_ns(self, frame: int, time_ns: int, gpu_since_ns: int, queued: int) -> int:
        """Return when a frame begins that could at `time_ns`.

        Parameters
        ----------
        gpu_since_ns
            When the GPU began the frame that it works on; -1 if it works on none.
        queued
            Frames that wait for the GPU.
        """
        ...

    def completed(self, cpu_ns: int, gpu_ns: int) -> None:
        """Learn what the next frame in order took."""
        ...

    def shown(self, frame: int, time_ns: int) -> None:
        """Learn when a frame was shown; of frames that never are, nothing is told."""
        ...


class Limiter:
    """Frames begin at least an interval apart."""

    def __init__(self, rate_hz: float) -> None:
        # Rounded up: a nanosecond too short would fill the queue in a day, one too long shows.
        self._interval_ns = -int(-_NS_PER_S // rate_hz)
        self._next_ns = 0

    def start_ns(self, frame: int, time_ns: int, gpu_since_ns: int, queued: int) -> int:
        """Return the time an interval after the last frame began, or now."""
        start_ns = max(time_ns, self._next_ns)
        self._next_ns = start_ns + self._interval_ns
        return start_ns

    def completed(self, cpu_ns: int, gpu_ns: int) -> None:
        """Need nothing."""

    def shown(self, frame: int, time_ns: int) -> None:
        """Need nothing."""


class JustInTime:
    """A frame begins so late that it is just finished before the refresh that it is for.

    It may take as long as the slowest but one of the last `HISTORY_FRAMES`, or a refresh.  Where
    frames mostly follow each other more slowly than refreshes, or there are none, it begins so late
    that it is submitted just before the GPU is free: to wait for a refresh would leave it idle.
    """

    def __init__(self, display: Display, frames_in_flight: int) -> None:
        self._period_ns = _NS_PER_S / display.refresh_hz
        self._refreshes = display.mode != "immediate"
        self._fixed = display.mode in ("vsync", "mailbox")
        self._one_by_one = display.mode != "mailbox"
        self._frames_in_flight = frames_in_flight
        self._cpu, self._gpu = _Times(), _Times()
        self._expected_ns = -self._period_ns  # when the frame before should be shown
        self._shown_frame, self._shown_ns = -1, -self._period_ns

    def start_ns(self, frame: int, time_ns: int, gpu_since_ns: int, queued: int) -> int:
        """Return when to begin so as to be in time; now if it is late, or nothing is known."""
        cpu_ns, gpu_ns = self._cpu.median_ns, self._gpu.median_ns
        free_ns = time_ns if gpu_since_ns < 0 else max(time_ns, gpu_since_ns + gpu_ns)
        free_ns += queued * gpu_ns
        latest_ns = free_ns - self._cpu.slow_ns - SAFETY_NS
        if self._refreshes:
            ready_ns = max(time_ns + cpu_ns, free_ns) + gpu_ns
            self._expected_ns = self._refresh_after(frame, ready_ns)
            apart_ns = max(cpu_ns, gpu_ns, (cpu_ns + gpu_ns) // self._frames_in_flight)
            if apart_ns < self._period_ns:
                # Waiting for one that takes more than a refresh would hold back all the others.
                period_ns = int(self._period_ns)
                slow_ns = min(self._cpu.slow_ns, period_ns) + min(self._gpu.slow_ns, period_ns)
                latest_ns = int(self._expected_ns) - slow_ns - SAFETY_NS
        # Nothing is known of a first frame's work, and waiting may miss a refresh.
        return max(time_ns, latest_ns) if gpu_ns else time_ns

    def completed(self, cpu_ns: int, gpu_ns: int) -> None:
        """Expect as much of the frames to come."""
        self._cpu.add(cpu_ns)
        self._gpu.add(gpu_ns)

    def shown(self, frame: int, time_ns: int) -> None:
        """Expect the frames after it at the refreshes after this."""
        self._shown_frame, self._shown_ns = frame, time_ns

    def _refresh_after(self, frame: int, ready_ns: int) -> float:
        """Return the first refresh at which a frame that is ready then can be shown."""
        between = frame - self._shown_frame
        turn_ns = self._shown_ns + (between if self._one_by_one else 1) * self._period_ns
        if between > 1:  # where the frame before has been shown, it is known and not expected
            turn_ns = max(turn_ns, self._expected_ns + self._period_ns)
        if not self._fixed:
            return max(turn_ns, ready_ns)
        tick = max(round(turn_ns / self._period_ns), ceil(ready_ns / self._period_ns))
        return tick * self._period_ns


class _Times:
    """The last `HISTORY_FRAMES` times: their median and the largest but one, 0 of none."""

    def __init__(self) -> None:
        self._last: deque[int] = deque()
        self._rising: list[int] = []
        self.median_ns = self.slow_ns = 0

    def add(self, time_ns: int) -> None:
        """Add a time, and forget the one that is too old."""
        last, rising = self._last, self._rising
        if len(last) == HISTORY_FRAMES:
            del rising[bisect_left(rising, last.popleft())]
        last.append(time_ns)
        insort(rising, time_ns)
        self.median_ns = rising[len(rising) // 2]
        self.slow_ns = rising[max(len(rising) - 2, 0)]  # one alone is a hitch, two are a load


def make_pacer(display: Display, frames_in_flight: int) -> Pacer | None:
    """Return what paces the frames of a display, None where nothing does."""
    if display.pacing == "limiter":
        return Limiter(display.limiter_hz or display.refresh_hz)
    if display.pacing == "just-in-time":
        return JustInTime(display, frames_in_flight)
    return None
