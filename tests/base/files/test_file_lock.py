"""Locks on files that end with their process."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lodbench.base.files.file_lock import holds, lock_file, unlock_file

HOLDER = (
    "import os, signal, sys, time\n"
    "from pathlib import Path\n"
    "from lodbench.base.files.file_lock import lock_file\n"
    "lock_file(Path(sys.argv[1]))\n"
    "if sys.argv[2] == 'fork' and os.fork() == 0:\n"
    "    time.sleep(60)\n"
    "print(os.getpid(), flush=True)\n"
    "time.sleep(60)\n"
)


def test_one_holds_it_and_then_another(tmp_path: Path) -> None:
    """A second handle of the same process is refused until the first gives the lock back."""
    path = tmp_path / "lock"
    first = lock_file(path)
    with pytest.raises(BlockingIOError):
        lock_file(path)
    unlock_file(first)
    assert not holds(first)
    second = lock_file(path, create=False)
    assert holds(second)
    unlock_file(second)
    unlock_file(second)


def test_a_lock_of_a_removed_file_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who gets the lock of a file that its holder has removed meanwhile locks the new one."""
    path = tmp_path / "lock"
    path.touch()
    opened, before = os.open, path.stat().st_ino

    def remove_behind(*arguments: object) -> int:
        handle = opened(*arguments)  # pyright: ignore[reportArgumentType]
        if os.fstat(handle).st_ino == before and path.stat().st_ino == before:
            path.rename(tmp_path / "removed")
        return handle

    monkeypatch.setattr(os, "open", remove_behind)
    handle = lock_file(path)
    assert os.path.samestat(os.fstat(handle), path.stat())
    unlock_file(handle)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.parametrize("how", ["alone", "fork"])
def test_a_killed_process_holds_nothing(tmp_path: Path, how: str) -> None:
    """Neither it nor a process that it forked, which lives on, keeps the lock."""
    path = tmp_path / "lock"
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(path), how],
        stdout=subprocess.PIPE,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        with pytest.raises(BlockingIOError):
            lock_file(path)
        process.kill()
        process.wait()
        time.sleep(0.2)  # the forked one may not have begun yet, and lets go when it does
        handle = lock_file(path)
        unlock_file(handle)
        if how == "fork":
            os.killpg(process.pid, signal.SIGKILL)
