"""Group commit: what is added is made durable soon, and many at a time.

Forcing a file to the disk takes some ten milliseconds, more than many a run.
"""

from collections.abc import Callable, Sequence
from threading import Condition, Thread
from typing import Generic, TypeVar

T = TypeVar("T")

HOLD_S = 0.25
"""How long something waits for others; half of what is promised, the other half is the disk's."""
GROUP = 64
"""So many wait for nobody."""


class GroupCommit(Generic[T]):
    """Hands what is added to a writer, from a thread of its own.

    Attributes
    ----------
    done : int
        How much of what was added is written.
    """

    def __init__(self, write: Callable[[Sequence[T]], None]) -> None:
        self._write = write
        self._waiting: list[T] = []
        self._urgent = self._closed = False
        self._error: BaseException | None = None
        self._added = self.done = 0
        self._changed = Condition()
        # A daemon, as a crash elsewhere must not wait for the disk.
        self._thread = Thread(target=self._run, name="results", daemon=True)
        self._thread.start()

    def add(self, item: T) -> None:
        """Leave something to be written; raises what an earlier write raised."""
        with self._changed:
            self._raise_error()
            self._waiting.append(item)
            self._added += 1
            self._changed.notify_all()

    def flush(self) -> None:
        """Return when all that was added is written; raises what a write raised."""
        with self._changed:
            self._urgent = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self.done == self._added or self._error is not None)
            self._urgent = False
            self._raise_error()

    def close(self) -> None:
        """Write all that was added, and end the thread; raises what a write raised."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join()
        self._raise_error()

    def _raise_error(self) -> None:
        if self._error is not None:
            raise self._error

    def _run(self) -> None:
        while group := self._next_group():
            try:
                self._write(group)
            except BaseException as error:  # noqa: BLE001  # it is raised where results are added
                with self._changed:
                    self._error = error
                    self._changed.notify_all()
                return
            with self._changed:
                self.done += len(group)
                self._changed.notify_all()

    def _next_group(self) -> list[T]:
        """Return what is to be written next; nothing at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._closed)
            self._changed.wait_for(
                lambda: len(self._waiting) >= GROUP or self._urgent or self._closed, HOLD_S
            )
            group, self._waiting = self._waiting, []
            return group
