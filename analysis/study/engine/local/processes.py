"""The caller's side of a worker process: how it is spoken to, and ended."""

import os
import select
import signal
import socket
import time
from collections import deque
from contextlib import suppress

from .launch import launch
from .messages import Inbox, Message, frame_task
from .minder import ENDED, STARTED
from .shared_file import Heart


class Worker:
    """One worker process, seen from the engine.

    Attributes
    ----------
    owner : str
        Whose tasks it carries out.
    queue : deque of int
        Tasks sent and not answered; the first is being carried out.
    since_ns : int
        When the first of the queue could begin, on the monotonic clock.
    started_s : float
        When it was asked for, on the same.
    deaf : bool
        Whether nothing more is expected of it.
    pid, minder : int
        Process ids of the worker and of its minder; 0 until they are known.
    """

    def __init__(self, owner: str, inputs_fd: int, setup: bytes, most_bytes: int) -> None:
        self.owner = owner
        self.queue: deque[int] = deque()
        self.since_ns = time.monotonic_ns()
        self.pid, self.minder = 0, 0
        self.started_s = time.monotonic()
        self.deaf = False
        self.heart = Heart()
        self.printed = b""
        self._inbox = Inbox(most_bytes)
        self._outbox = bytearray()
        self._about = b""
        self.channel, self.control = launch(inputs_fd, self.heart.fd)
        self.channel.setblocking(False)
        self.control.setblocking(False)
        self._send(frame_task(-1, setup))

    @property
    def sending(self) -> bool:
        """Whether something waits to be sent."""
        return bool(self._outbox)

    def give(self, task: int, data: bytes) -> None:
        """Hand over a task."""
        if not self.queue:
            self.since_ns = time.monotonic_ns()
        self.queue.append(task)
        self._send(frame_task(task, data))

    def flush(self) -> None:
        """Send what waits, as far as it goes."""
        try:
            while self._outbox:
                del self._outbox[: self.channel.send(self._outbox)]
        except BlockingIOError:
            pass
        except OSError:  # it has ended, which its minder will say
            self._outbox.clear()

    def _send(self, data: bytes) -> None:
        self._outbox += data
        self.flush()

    def receive(self) -> list[Message]:
        """Return whole messages; raises EOFError or `GarbledError` as `Inbox.read`."""
        return list(self._inbox.read(self.channel))

    def ended(self) -> bool:
        """Whether the minder has said its last word."""
        try:
            while chunk := self.control.recv(65536):
                self._about += chunk
        except BlockingIOError:
            self._read_pids()
            return False
        except OSError:
            pass
        self._read_pids()
        self.printed = self._about[STARTED.size + ENDED.size :]
        return True

    def _read_pids(self) -> None:
        if not self.minder and len(self._about) >= STARTED.size:
            self.minder, self.pid = STARTED.unpack_from(self._about)

    @property
    def status(self) -> int | None:
        """Exit status, negative for a signal; None if nobody knows it."""
        if len(self._about) < STARTED.size + ENDED.size:
            return None
        return ENDED.unpack_from(self._about, STARTED.size)[0]

    def kill(self) -> None:
        """Have the minder kill it."""
        with suppress(OSError):
            self.control.send(b"k")

    def give_up(self) -> None:
        """Take it for ended: it was never started."""
        self.control.shutdown(socket.SHUT_RDWR)

    def force(self) -> None:
        """Kill it and its minder, which does not answer."""
        if os.name != "posix":
            return
        for pid, kill in ((self.pid, os.killpg), (self.minder, os.kill)):
            if pid > 0:
                with suppress(OSError):
                    kill(pid, signal.SIGKILL)

    def close(self) -> None:
        """Let go of it; what still lives is killed by its minder."""
        self.channel.close()
        self.control.close()
        self.heart.close()


def end_all(workers: list[Worker], within_s: float = 2.0) -> None:
    """Kill workers and wait until they have ended."""
    until = time.monotonic() + within_s
    left = {worker.control.fileno(): worker for worker in workers}
    for worker in workers:
        worker.kill()
    while left and time.monotonic() < until:
        for fd in select.select(list(left), [], [], 0.1)[0]:
            if left[fd].ended():
                del left[fd]
    for worker in left.values():
        worker.force()
    for worker in workers:
        worker.close()
