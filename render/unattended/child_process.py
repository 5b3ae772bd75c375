"""A command that runs for so long and no longer."""

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress


class ChildError(Exception):
    """A command failed, or was stopped because its time was up."""


def run_child(command: Sequence[str], *, limit_s: float, more: Mapping[str, str]) -> str:
    """Run a command, with `more` in its environment, and return what it printed.

    It is asked nothing.  At the end of its time, or if this process is stopped, it is killed with
    all that it started, since a driver that hangs does not heed anything milder.

    Raises `ChildError`, with the last line on stderr, if the command fails or its time is up.
    """
    with subprocess.Popen(  # noqa: S603 - commands of our own
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        env={**os.environ, **more},
        start_new_session=True,
    ) as child:
        try:
            printed, wrong = child.communicate(timeout=max(limit_s, 0.0))
        except subprocess.TimeoutExpired:
            raise ChildError(f"stopped after {limit_s:.0f} s") from None
        finally:
            with suppress(ProcessLookupError):  # it is over, as it should be
                os.killpg(child.pid, signal.SIGKILL)
    if child.returncode != 0:
        raise ChildError((wrong.strip().splitlines() or [f"exit {child.returncode}"])[-1])
    return printed
