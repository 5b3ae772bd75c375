"""The event queue: a heap of tuples on an integer clock.

Event times are int64 nanoseconds, so that sums are exact and two events are simultaneous only when
they really are.  Simultaneous events run in the order of their priority, then in the order in which
they were scheduled.
"""

from collections.abc import Callable
from heapq import heappop, heappush

Handler = Callable[[int, int], None]
"""Called with the time in ns and the subject (a frame index, a request) of the event."""


class EventQueue:
    """Future events as ``(time_ns, priority, seq, handler, subject)``; a loop, not coroutines."""

    def __init__(self) -> None:
        self._heap: list[tuple[int, int, int, Handler, int]] = []
        self._seq = 0
        self.now_ns = 0

    def __len__(self) -> int:
        """Return the number of events still to come."""
        return len(self._heap)

    def schedule(self, time_ns: int, priority: int, handler: Handler, subject: int) -> None:
        """Call ``handler(time_ns, subject)`` at a time that is not in the past."""
        assert time_ns >= self.now_ns, "an event cannot be scheduled in the past"
        self._seq = seq = self._seq + 1
        heappush(self._heap, (time_ns, priority, seq, handler, subject))

    def run(self) -> None:
        """Run events in order until none is left."""
        heap = self._heap
        while heap:
            time_ns, _, _, handler, subject = heappop(heap)
            self.now_ns = time_ns
            handler(time_ns, subject)
