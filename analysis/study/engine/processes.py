"""The caller's side of worker processes: how they are started, spoken to, and ended."""

import atexit
import json
import os
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import deque
from contextlib import suppress

from ....base.errors import InputError
from .messages import Inbox, Message, frame_task
from .minder import ENDED, STARTED
from .shared_file import Heart
from .worker import THREADS

_START = """
import json, sys
sys.path[:] = json.loads(sys.argv[2])
from {package}.fork_server import serve
serve(int(sys.argv[1]))
"""
_ATTEMPTS = 3


class ForkServer:
    """The process that forks workers, started when it is first needed, and again if it is gone."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._requests: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0

    def fork(self, fds: tuple[int, ...]) -> None:
        """Fork a worker that has these descriptors.

        Raises `InputError` if there is no server to be had.
        """
        with self._lock:
            for _ in range(_ATTEMPTS):
                try:
                    socket.send_fds(self._running(), [b"f"], fds)
                except OSError:  # it has ended
                    self._end()
                else:
                    return
        raise InputError(
            f"workers: expected {sys.executable} to start, got a process that ended; is the "
            "installation whole?"
        )

    def warm_up(self) -> None:
        """Start the server, so that it loads its modules while the caller does something else."""
        with self._lock:
            self._running()

    def _running(self) -> socket.socket:
        """Return the socket of a server of this very process."""
        if self._process is not None and self._owner != os.getpid():  # we were forked
            self._process.returncode = 0
            self._process = None
        if self._process is None or self._requests is None:
            return self._start()
        return self._requests

    def restart(self) -> None:
        """End a server that does not answer; the next worker starts another."""
        with self._lock:
            self._end()

    def _end(self) -> None:
        """End the server, with which nothing else ends."""
        if self._process is not None and self._owner == os.getpid():
            self._process.kill()
            self._process.wait()
            self._process = None
        if self._requests is not None:
            self._requests.close()
            self._requests = None

    def _start(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        hashes = {"PYTHONHASHSEED": "0"}  # sets of text are walked in the same order every time
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603 - our own module
                [
                    sys.executable,
                    "-c",
                    _START.format(package=__package__),
                    str(theirs.fileno()),
                    json.dumps([str(entry) for entry in sys.path]),
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
                env=hashes | dict(os.environ) | THREADS,
                start_new_session=True,  # Ctrl-C is for the caller
            )
        self._requests, self._owner = ours, os.getpid()
        atexit.register(self._end)
        return ours


SERVER = ForkServer()
"""That of this process."""


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
        self.channel, theirs = socket.socketpair()
        self.control, minders = socket.socketpair()
        with theirs, minders:
            fds = (minders.fileno(), theirs.fileno(), inputs_fd, self.heart.fd)
            SERVER.fork(fds)
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
