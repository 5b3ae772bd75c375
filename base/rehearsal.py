"""A rehearsal of a user's code in a copy of this process, which the code may end or hang.

A file that calls ``os._exit(0)`` when it is loaded would end a command without a word and with the
exit code of success.
"""

import os
import select
import signal
import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from .errors import InputError

LONGEST_S = 60.0
"""What loading a file may take."""


def rehearse(load: Callable[[], object], path: Path) -> None:
    """Call a function in a copy of this process, whatever it raises there.

    Does nothing where the system cannot copy a process, or other threads run in this one: they may
    hold locks that nobody in the copy would free.

    Raises `InputError` if the copy ends, or is busy for more than `LONGEST_S`.
    """
    if not hasattr(os, "fork") or threading.active_count() > 1:
        return
    reader, writer = os.pipe()
    with warnings.catch_warnings():
        # Of threads of numerical libraries, which look after themselves in a copy.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        _perform(load, writer)
    os.close(writer)
    done, status = _wait(child, reader)
    if not done:
        how = "is not done in time" if status is None else f"ends the process with status {status}"
        raise InputError(f"expected a Python file that loads, got one that {how}", path=path)


def _perform(load: Callable[[], object], writer: int) -> NoReturn:
    """Call the function in the copy, and tell that it has come to its end."""
    try:
        quiet = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):  # all is said once more when the file is loaded for good
            os.dup2(quiet, stream)
        with suppress(BaseException):
            load()
        os.write(writer, b".")
    finally:
        os._exit(1)


def _wait(child: int, reader: int) -> tuple[bool, int | None]:
    """Return whether the copy came to its end, and with which status it ended; None if killed."""
    try:
        heard, _, _ = select.select([reader], [], [], LONGEST_S)
        done = bool(heard) and os.read(reader, 1) != b""
        if done or not heard:
            os.kill(child, signal.SIGKILL)  # threads that it started may go on
    finally:
        os.close(reader)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return done, status if heard else None
