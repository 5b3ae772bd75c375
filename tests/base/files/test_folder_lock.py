"""A folder has one writer at a time, who is named."""

import os
import platform
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files import folder_lock
from lodbench.base.files.folder_lock import lock_path, locked

HOLDER = (
    "import sys, time\n"
    "from pathlib import Path\n"
    "from lodbench.base.files.folder_lock import locked\n"
    "with locked(Path(sys.argv[1])):\n"
    "    print('held', flush=True)\n"
    "    time.sleep(60)\n"
)


def test_a_second_writer_is_told_who_writes(tmp_path: Path) -> None:
    """Process, machine and time of the first are named in one line, until it is killed."""
    folder = tmp_path / "run"
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(folder)], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        with pytest.raises(InputError) as caught, locked(folder):
            pass
        process.kill()
    assert process.returncode == -signal.SIGKILL
    host = re.sub(r"[^\w.-]", "_", platform.node())
    assert re.fullmatch(
        rf"{folder}: expected a folder that nobody writes to, got one that process {process.pid} "
        rf"on {host} writes since 20\d\d-\d\d-\d\d \d\d:\d\d:\d\d UTC; wait for it or name another",
        str(caught.value),
    )
    assert lock_path(folder).exists()
    with locked(folder):
        assert f"process {os.getpid()} on" in lock_path(folder).read_text(encoding="utf-8")
    assert list(tmp_path.iterdir()) == []


def test_other_folders_are_free(tmp_path: Path) -> None:
    """A lock is of one folder, by whichever path it is reached."""
    (tmp_path / "link").symlink_to("run")
    with locked(tmp_path / "run"), locked(tmp_path / "other"):
        assert refusal(tmp_path / "link")
        assert not refusal(tmp_path / "third")


def refusal(folder: Path) -> str | None:
    """Return why a thread of its own may not write to a folder, or None."""
    answers: list[str | None] = []

    def ask() -> None:
        try:
            with locked(folder):
                answers.append(None)
        except InputError as error:
            answers.append(error.message)

    thread = threading.Thread(target=ask)
    thread.start()
    thread.join()
    return answers[0]


def test_who_holds_it_may_write(tmp_path: Path) -> None:
    """A block within the one that holds the folder holds it too, and gives nothing back."""
    folder = tmp_path / "run"
    with locked(folder):
        with locked(folder):
            pass
        assert refusal(folder)
    assert not refusal(folder)


def test_folders_above_are_made_and_removed(tmp_path: Path) -> None:
    """Parents are made for the lock; those that hold nothing afterwards are gone again."""
    folder = tmp_path / "a" / "b" / "run"
    with locked(folder, make_parents=True):
        assert folder.parent.is_dir()
    assert list(tmp_path.iterdir()) == []
    with locked(folder, make_parents=True):
        folder.mkdir()
    assert folder.is_dir()


def test_a_folder_above_that_another_removes_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another writer below the same new folder, who ends first, takes nothing away."""
    folder, lock = tmp_path / "new" / "run", folder_lock.lock_file

    def remove_once(path: Path) -> int:
        monkeypatch.setattr(folder_lock, "lock_file", lock)
        path.parent.rmdir()
        return lock(path)

    monkeypatch.setattr(folder_lock, "lock_file", remove_once)
    with locked(folder, make_parents=True):
        assert refusal(folder)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", ["file/run", "file/a/run", "absent/run", "/proc/run", "loop/run"])
def test_no_place_for_a_lock_is_told(tmp_path: Path, place: str) -> None:
    """One line names the folder that was asked for."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    (tmp_path / "loop").symlink_to("loop")
    make_parents = "absent" not in place
    with (
        pytest.raises(InputError, match="expected a folder beside which a lock can be") as caught,
        locked(tmp_path / place, make_parents=make_parents),
    ):
        pass
    assert caught.value.path == str(tmp_path / place)


@pytest.mark.parametrize("left", ["", "process\n1 on x", "\x1b[31m" + "x" * 1000])
def test_what_stands_in_a_lock_is_not_believed(tmp_path: Path, left: str) -> None:
    """A lock that is just taken says nothing yet, and one of somebody else could say anything."""
    folder = tmp_path / "run"
    with locked(folder):
        lock_path(folder).write_text(left, encoding="utf-8")
        assert "got one that another process writes; wait" in str(refusal(folder))


def test_a_link_in_the_place_of_a_lock_is_not_followed(tmp_path: Path) -> None:
    """In a folder that others write to, a link could lead to any file of ours."""
    theirs, folder = tmp_path / "theirs", tmp_path / "run"
    theirs.write_text("mine", encoding="utf-8")
    lock_path(folder).symlink_to(theirs)
    with pytest.raises(InputError, match="expected a folder beside which a lock"), locked(folder):
        pass
    assert theirs.read_text(encoding="utf-8") == "mine"


def test_names_as_long_as_they_may_be(tmp_path: Path) -> None:
    """A name of 255 bytes has no room for more, so that its lock is named by a digest."""
    folder = tmp_path / ("ü" * 127 + "x")
    folder.mkdir()
    with locked(folder):
        assert refusal(folder)


def test_without_locks_nobody_is_kept_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file system that knows no locks is written to all the same."""

    def refuse(*_: object, **__: object) -> int:
        raise OSError(folder_lock.errno.ENOLCK, "No locks available")

    monkeypatch.setattr(folder_lock, "lock_file", refuse)
    assert not refusal(tmp_path / "run")
