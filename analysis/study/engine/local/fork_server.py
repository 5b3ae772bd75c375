"""A small process that has the heavy modules loaded and forks workers on request.

A worker starts in some 15 ms in this way, not in the second that imports take.  The server runs no
policy, and no process that does is its child: between them stands the worker's minder.  One server
serves all engines of a process, and ends with it.
"""

import gc
import os
import select
import signal
import socket
from contextlib import suppress
from importlib import import_module

from .minder import mind

_FDS = 4


def serve(fd: int) -> None:
    """Fork a minder with its worker for each request, until the other end is closed."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)  # the caller's to handle, who then closes the socket
    requests = socket.socket(fileno=fd)
    import_module("...run", __package__)
    _load_policies(requests)
    gc.freeze()  # what is loaded stays, and looking at it would copy its pages
    while True:
        _answer(requests)


def _answer(requests: socket.socket) -> None:
    """Wait for a request and fork a minder for it; end when there will be no more."""
    data, fds, _, _ = socket.recv_fds(requests, 1, _FDS)
    if not data:
        os._exit(0)
    pid = -1
    with suppress(OSError):  # no process to be had: the engine sees its socket closed
        pid = os.fork()
    if pid == 0:
        try:
            requests.close()
            control, channel, inputs, heart = fds
            mind(socket.socket(fileno=control), socket.socket(fileno=channel), inputs, heart)
        finally:
            os._exit(1)
    for fd in fds:
        os.close(fd)
    with suppress(ChildProcessError):  # minders that have ended
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass


def _load_policies(requests: socket.socket) -> None:
    """Import our policies, as long as nobody asks for a worker.

    What single ones import when they need it (scipy, casadi) is left out: each start of a worker
    would copy the tables of its pages.
    """
    from .....policies.registry import REGISTERED

    for name in list(REGISTERED):
        while select.select([requests], [], [], 0.0)[0]:
            _answer(requests)
        with suppress(Exception):  # who needs it will be told why
            REGISTERED.find(name)
