"""Screens: when a finished frame is shown and when its swapchain image is free again.

A screen is offered finished frames in order.  It shows each at some time or drops it, and calls
`freed` whenever an image can be drawn into again: the image shown before, or a dropped one.
"""

from abc import abstractmethod
from collections import deque
from collections.abc import Callable
from typing import Protocol

from ...models.machine.hardware import Display
from .events import EventQueue

DROPPED_NS = -2
"""Time that a screen reports for a frame that it will never show."""

_PRIORITY = 1  # after a GPU completion of the same nanosecond: a frame done at the vblank is shown
_NS_PER_S = 1_000_000_000

Shown = Callable[[int, int], None]
"""Called with time and frame; a time of `DROPPED_NS` says that the frame is dropped."""
Freed = Callable[[int], None]
"""Called with the time at which an image became free."""


class Screen(Protocol):
    """What the pipeline needs of a display mode."""

    def offer(self, time_ns: int, frame: int) -> None:
        """Take a finished frame."""
        ...


class Immediate:
    """Every frame is shown when it is finished, tearing if need be."""

    def __init__(self, shown: Shown, freed: Freed) -> None:
        self._shown, self._freed = shown, freed
        self._front = False

    def offer(self, time_ns: int, frame: int) -> None:
        """Show the frame now."""
        self._shown(time_ns, frame)
        if self._front:
            self._freed(time_ns)
        self._front = True


class Refreshing:
    """Finished frames wait in order; each refresh of the panel shows the oldest."""

    def __init__(self, events: EventQueue, shown: Shown, freed: Freed) -> None:
        self._events, self._shown, self._freed = events, shown, freed
        self._pending: deque[int] = deque()
        self._front = False

    def offer(self, time_ns: int, frame: int) -> None:
        """Queue the frame for the first refresh that no earlier frame takes."""
        self._pending.append(frame)
        if len(self._pending) == 1:
            self._schedule(time_ns)

    @abstractmethod
    def _schedule(self, time_ns: int) -> None:
        """Have `_refresh` called at the next refresh that may show a frame."""

    def _refresh(self, time_ns: int, _subject: int) -> None:
        self._shown(time_ns, self._pending.popleft())
        if self._pending:
            self._schedule(time_ns)
        if self._front:
            self._freed(time_ns)
        self._front = True


class Vsync(Refreshing):
    """The panel refreshes at a fixed rate, whether there is a frame to show or not."""

    def __init__(self, events: EventQueue, refresh_hz: float, shown: Shown, freed: Freed) -> None:
        super().__init__(events, shown, freed)
        self._refresh_hz = refresh_hz
        self._tick = -1  # the last vblank that was used or is scheduled

    def _schedule(self, time_ns: int) -> None:
        # Vblank n is at round(n · period): half a nanosecond off at most, and never accumulating.
        tick = self._tick + 1
        at_ns = round(tick * _NS_PER_S / self._refresh_hz)
        if at_ns < time_ns:  # vblanks have passed with nothing to show
            tick = int(time_ns * self._refresh_hz / _NS_PER_S)
            while (at_ns := round(tick * _NS_PER_S / self._refresh_hz)) < time_ns:
                tick += 1
        self._tick = tick
        self._events.schedule(at_ns, _PRIORITY, self._refresh, tick)


class Mailbox(Vsync):
    """A vblank shows the newest finished frame; the one that it replaces is dropped."""

    def offer(self, time_ns: int, frame: int) -> None:
        """Take the place of any frame that waits for the same vblank."""
        if not self._pending:
            super().offer(time_ns, frame)
            return
        self._shown(DROPPED_NS, self._pending.pop())
        self._pending.append(frame)
        self._freed(time_ns)


class Vrr(Refreshing):
    """The panel starts a refresh when a frame is finished, within its range of rates.

    A refresh takes the shortest period.  When no frame comes within the longest period the panel
    shows the old one again, and a frame that is finished meanwhile waits for that refresh to end.
    Where the range spans a factor of two, low-framerate compensation keeps out of its way: the next
    frame is expected as long after the last as that was finished after the one before, and if no
    single period is so long the old one is repeated evenly until then, as seldom as may be.
    """

    def __init__(self, events: EventQueue, display: Display, shown: Shown, freed: Freed) -> None:
        super().__init__(events, shown, freed)
        self._shortest_ns = round(_NS_PER_S / display.refresh_hz)
        self._longest_ns = max(round(_NS_PER_S / display.vrr_min_hz), self._shortest_ns)
        # Half of what exceeds the longest period has to be a period of the range.
        self._compensates = self._longest_ns >= 2 * self._shortest_ns
        self._last_ns = -self._shortest_ns  # begin of the last refresh
        self._offered_ns = self._next_ns = -1  # when the last came, when the next is expected
        self._even_ns, self._even = self._longest_ns, 0  # repeats that are planned

    def offer(self, time_ns: int, frame: int) -> None:
        """Take a finished frame, and expect the next one after as long a time."""
        if self._offered_ns >= 0:
            self._next_ns = 2 * time_ns - self._offered_ns
        self._offered_ns = time_ns
        super().offer(time_ns, frame)

    def _schedule(self, time_ns: int) -> None:
        planned = min(self._even, max(0, (time_ns - self._last_ns - 1) // self._even_ns))
        self._even -= planned
        self._last_ns += planned * self._even_ns
        repeats = max(0, (time_ns - self._last_ns - 1) // self._longest_ns)
        self._last_ns += repeats * self._longest_ns
        at_ns = max(time_ns, self._last_ns + self._shortest_ns)
        self._events.schedule(at_ns, _PRIORITY, self._refresh, 0)

    def _refresh(self, time_ns: int, _subject: int) -> None:
        span_ns = self._next_ns - time_ns
        self._even = 0
        if self._compensates and span_ns > self._longest_ns:
            refreshes = -(-span_ns // self._longest_ns)
            self._even_ns, self._even = span_ns // refreshes, refreshes - 1
        self._last_ns = time_ns
        super()._refresh(time_ns, _subject)


def make_screen(display: Display, events: EventQueue, shown: Shown, freed: Freed) -> Screen:
    """Return the screen of a display mode."""
    if display.mode == "immediate":
        return Immediate(shown, freed)
    if display.mode == "vsync":
        return Vsync(events, display.refresh_hz, shown, freed)
    if display.mode == "mailbox":
        return Mailbox(events, display.refresh_hz, shown, freed)
    return Vrr(events, display, shown, freed)
