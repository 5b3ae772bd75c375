"""How worker processes are started: forked by a server, or, where none can fork, one by one."""

import atexit
import json
import os
import socket
import subprocess
import sys
import threading

from .....base.errors import InputError
from .spawned import spawn
from .worker import surroundings

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
        if FORKS:
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
                env=surroundings(),
                start_new_session=True,  # Ctrl-C is for the caller
            )
        self._requests, self._owner = ours, os.getpid()
        atexit.register(self._end)
        return ours


SERVER = ForkServer()
"""That of this process."""

FORKS = hasattr(os, "fork")


def launch(inputs: int, heart: int) -> tuple[socket.socket, socket.socket]:
    """Start a worker; return the sockets to it and to what minds it.

    Raises `InputError` if no process can be started.

    Parameters
    ----------
    inputs, heart
        Descriptors of the files that it shares with its engine.
    """
    channel, theirs = socket.socketpair()
    control, minders = socket.socketpair()
    with theirs:
        if FORKS:
            with minders:
                SERVER.fork((minders.fileno(), theirs.fileno(), inputs, heart))
        else:
            spawn(minders, theirs, inputs, heart)
    return channel, control
