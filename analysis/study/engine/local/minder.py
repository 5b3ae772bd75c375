"""The process beside each worker: it kills the worker when told to, and says how it ended.

It runs no policy and reads nothing of one, and so outlives whatever a policy does.  It keeps the
last of what the worker prints, and when the engine's process has gone it ends the worker.
"""

import ctypes
import os
import select
import signal
import socket
import struct
import sys
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from .worker import work

STARTED = struct.Struct("<qq")
"""First message to the engine: process ids of the minder and of the worker, 0 if there is none."""
ENDED = struct.Struct("<q")
"""Second and last: exit status as `os.waitstatus_to_exitcode` has it; then what was printed."""

_PRINTED_BYTES = 4096
_LOOK_MS = 1000
_PDEATHSIG, _SUBREAPER = 1, 36
_CHILDREN = Path("/proc/thread-self/children")


def mind(control: socket.socket, channel: socket.socket, inputs: int, heart: int) -> NoReturn:
    """Start a worker and mind it until it has ended; never returns.

    Parameters
    ----------
    control : to the engine
    channel, inputs, heart : the worker's, see `work`
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    _prctl(_SUBREAPER, 1)  # what the worker's children leave behind comes here
    wake, woken = os.pipe()
    for end in (wake, woken):
        os.set_blocking(end, False)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, _wake)
    printed, prints = os.pipe()
    minder = os.getpid()
    try:
        worker = os.fork()
    except OSError:  # no process to be had
        control.sendall(STARTED.pack(minder, 0))
        os._exit(1)
    if worker == 0:
        try:
            control.close()
            for fd in (wake, woken, printed):
                os.close(fd)
            _settle(minder, prints)
            work(channel, inputs, heart)
        finally:
            os._exit(1)
    for fd in (channel.detach(), inputs, heart, prints):
        os.close(fd)
    os.set_blocking(printed, False)
    control.sendall(STARTED.pack(minder, worker))
    status, text = _watch(worker, control, wake, printed)
    try:
        control.sendall(ENDED.pack(status) + text)
    finally:
        os._exit(0)


def _wake(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: that there is a handler has the system write to what is waited for."""


def _settle(minder: int, prints: int) -> None:
    """Make a fresh worker a process on its own, deaf to the terminal, with its output caught."""
    signal.set_wakeup_fd(-1)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGCHLD):
        signal.signal(number, signal.SIG_DFL)
    os.setsid()
    _prctl(_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != minder:  # it ended meanwhile
        os._exit(1)
    os.dup2(prints, 1)
    os.dup2(prints, 2)
    os.close(prints)
    out = [open(fd, "w", buffering=1, closefd=False, errors="replace") for fd in (1, 2)]  # noqa: SIM115 - descriptors that stay open
    sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__ = out


def _watch(worker: int, control: socket.socket, wake: int, printed: int) -> tuple[int, bytes]:
    """Return how the worker ended and the last of what it printed."""
    poll = select.poll()
    for fd in (control.fileno(), wake, printed):
        poll.register(fd, select.POLLIN)
    text = b""
    while True:
        for fd, _ in poll.poll(_LOOK_MS):
            if fd == control.fileno():  # told to, or the engine has gone
                _kill(worker)
                poll.unregister(fd)
            elif fd == printed:
                chunk = _read(printed)
                text = (text + chunk)[-_PRINTED_BYTES:]
                if not chunk:
                    poll.unregister(printed)
            else:
                _read(wake)
        pid, status = os.waitpid(worker, os.WNOHANG)
        if pid:
            _kill(worker)
            _end_orphans()
            while chunk := _read(printed):
                text = (text + chunk)[-_PRINTED_BYTES:]
            return os.waitstatus_to_exitcode(status), text


def _read(fd: int) -> bytes:
    try:
        return os.read(fd, 65536)
    except BlockingIOError:
        return b""


def _kill(worker: int) -> None:
    """Kill the worker's process group."""
    for kill in (os.killpg, os.kill):
        try:
            kill(worker, signal.SIGKILL)
        except (ProcessLookupError, PermissionError):
            continue


def _end_orphans() -> None:
    """Kill what the worker's children and theirs have left, also beyond its process group."""
    for _ in range(1000):
        try:
            children = [int(pid) for pid in _CHILDREN.read_text(encoding="ascii").split()]
        except OSError:
            return
        for pid in children:
            try:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
            except OSError:
                continue
        if not children:
            return


def _prctl(option: int, value: int) -> None:
    """Set a property of this process on Linux; elsewhere there is none such."""
    if sys.platform != "linux":
        return
    libc: Any = ctypes.CDLL(None)
    libc.prctl(option, value, 0, 0, 0)
