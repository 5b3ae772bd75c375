"""No worker outlives the command that started it, however that ends, and nothing is left behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

SLEEPS = """
import ctypes
import os
from pathlib import Path

from lodbench.policies.bounds.full import Full


class Sleeps(Full):
    def select(self, view):
        Path("started", str(os.getpid())).touch()
        if view.frame == 3:
            if os.fork() == 0:
                os.setsid()
            Path("started", str(os.getpid())).touch()
            ctypes.PyDLL(None).sleep(1000)  # holds the interpreter's lock
        return super().select(view)
"""
WITHIN_S = 2.0


def wait_until(condition: object, seconds: float) -> bool:
    """Return whether a condition, a function, came true in time."""
    assert callable(condition)
    until = time.monotonic() + seconds
    while not condition() and time.monotonic() < until:
        time.sleep(0.01)
    return bool(condition())


def lives(pid: str) -> bool:
    """Whether a process still does something."""
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split()[2] != "Z"
    except OSError:
        return False


def still_there(started: Path) -> list[str]:
    """Return the processes that do something, of those that have started so far."""
    return [path.name for path in started.iterdir() if lives(path.name)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "code", "said"),
    [
        (signal.SIGINT, 130, "interrupted: nothing more is written\n"),
        (signal.SIGTERM, 143, "interrupted: nothing more is written\n"),
        (signal.SIGKILL, -signal.SIGKILL, ""),
    ],
)
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="processes are looked up in /proc")
def test_workers_end_with_the_command(
    number: signal.Signals, code: int, said: str, tmp_path: Path
) -> None:
    """A signal to the command alone ends workers that hear nothing, and their children, in time.

    One of three commands has to: other work on the machine only delays them.
    """
    for attempt in range(3):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        if end_within(number, code, said, folder):
            return
    pytest.fail(f"workers lived longer than {WITHIN_S} s, three times")


def end_within(number: signal.Signals, code: int, said: str, tmp_path: Path) -> bool:
    """Return whether workers end in time with a command that gets a signal; check what is left."""
    (tmp_path / "mine.py").write_text(SLEEPS, encoding="utf-8")
    started, scratch = tmp_path / "started", tmp_path / "scratch"
    started.mkdir()
    scratch.mkdir()
    # Nobody else is compared, so that no run can be done and kept before the signal.
    command = [sys.executable, "-m", "lodbench", "compare", "--policy", "mine.py:Sleeps"]
    command += ["--workers", "2", "--scene", "plaza", "--trace", "walk", "--out", "out"]
    with subprocess.Popen(
        command,
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(scratch)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        # A worker and its child, or two workers and theirs: who looks too late sees more than two.
        assert wait_until(lambda: len(list(started.iterdir())) >= 2, 180.0)
        process.send_signal(number)
        in_time = wait_until(lambda: not still_there(started), WITHIN_S)
        assert in_time or wait_until(lambda: not still_there(started), 30.0)
        printed, complained = process.communicate(timeout=30.0)
    assert (process.returncode, printed, complained) == (code, "", said)
    assert list(scratch.iterdir()) == []
    left = {path.name for path in tmp_path.iterdir()} - {"mine.py", "scratch", "started"}
    # What a command that could do nothing more held is swept by the next that writes there.
    held = {".lodbench-out.lock", ".lodbench-out.unfinished"}
    assert left <= (held if number == signal.SIGKILL else set())
    return in_time
