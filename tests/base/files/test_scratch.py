"""A folder of unfinished work belongs to who holds its lock, whatever number its process had."""

import errno
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.base.files import scratch
from lodbench.base.files.file_lock import lock_file, unlock_file
from lodbench.base.files.scratch import scratch_beside, sweep


def left_by(folder: Path, process: int) -> Path:
    """Return a scratch folder of a process, without a lock in it."""
    left = folder / f".lodbench-{platform.node()}-{process}-abc.partial"
    left.mkdir()
    return left


@pytest.fixture(scope="module")
def dead() -> int:
    """Return the number of a process that has ended."""
    code = "import os; print(os.getpid())"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    return int(ended.stdout)


def test_a_number_that_came_again_keeps_nothing(tmp_path: Path) -> None:
    """A folder under the number of a process that runs, whose lock is free, is nobody's."""
    left = left_by(tmp_path, os.getpid())
    (left / "lock").touch()
    sweep(tmp_path)
    assert not left.exists()


def test_what_is_held_stays(tmp_path: Path, dead: int) -> None:
    """The lock counts where the number is of another machine's processes, as in a container."""
    left = left_by(tmp_path, dead)
    lock = lock_file(left / "lock")
    sweep(tmp_path)
    assert left.exists()
    unlock_file(lock)
    sweep(tmp_path)
    assert not left.exists()


def test_before_there_is_a_lock_the_number_counts(tmp_path: Path, dead: int) -> None:
    """What is just being made stays; what was left at that instant goes."""
    mine, theirs = left_by(tmp_path, os.getpid()), left_by(tmp_path, dead)
    sweep(tmp_path)
    assert mine.exists()
    assert not theirs.exists()


def test_a_folder_that_is_swept_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process may take the new folder for left behind at just that instant."""

    def sweep_first(path: Path) -> int:
        monkeypatch.setattr(scratch, "lock_file", lock_file)
        path.parent.rmdir()
        return lock_file(path)

    monkeypatch.setattr(scratch, "lock_file", sweep_first)
    with scratch_beside(tmp_path / "out", tmp_path / "out") as made:
        assert sorted(path.name for path in made.iterdir()) == ["lock", "new"]
    assert list(tmp_path.iterdir()) == []


def test_without_locks_numbers_have_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, dead: int
) -> None:
    """On a file system that has none, work goes on, and what dead processes left is removed."""

    def refuse(*_: object, **__: object) -> int:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(scratch, "lock_file", refuse)
    left = left_by(tmp_path, dead)
    with scratch_beside(tmp_path / "out", tmp_path / "out") as made:
        assert not left.exists()
        sweep(tmp_path)
        assert made.exists()
    assert list(tmp_path.iterdir()) == []
