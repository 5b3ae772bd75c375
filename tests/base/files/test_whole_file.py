"""Files written whole or not at all."""

import errno
import os
import resource
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files.whole_file import whole_file, whole_text_file, write_whole

INTERRUPTIONS = [ValueError, KeyboardInterrupt, SystemExit]


def run(code: str, *arguments: str) -> int:
    """Run a program of its own and return its exit code, negative for a signal."""
    return subprocess.run([sys.executable, "-c", code, *arguments], check=False).returncode


def test_replaces_what_was_there(tmp_path: Path) -> None:
    """The file holds what was written, line ends as given, and nothing is beside it."""
    path = tmp_path / "out.txt"
    path.write_text("old")
    with whole_text_file(path) as file:
        file.write("new\n")
        assert path.read_text() == "old"
    assert path.read_bytes() == b"new\n"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("interruption", INTERRUPTIONS)
def test_interruption_leaves_the_old_file(
    tmp_path: Path, interruption: type[BaseException]
) -> None:
    """An error, Ctrl-C or exit in the middle leaves what was there, and nothing beside it."""
    path = tmp_path / "out.txt"
    path.write_text("old")

    def write_half() -> None:
        with whole_text_file(path) as file:
            file.write("half")
            raise interruption

    with pytest.raises(interruption):
        write_half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_the_next_write_removes_what_a_killed_run_left(tmp_path: Path) -> None:
    """A killed process cleans nothing up; what one that still runs is writing stays."""
    path = tmp_path / "out.txt"
    killed = run(
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from lodbench.base.files.whole_file import whole_text_file\n"
        "with whole_text_file(Path(sys.argv[1])) as file:\n"
        "    file.write('half')\n"
        "    file.flush()\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n",
        str(path),
    )
    assert killed == -signal.SIGKILL
    assert len(list(tmp_path.iterdir())) == 1
    with whole_file(tmp_path / "other.txt") as partial:
        partial.write_text("written meanwhile")
        write_whole(path, "whole")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["other.txt", "out.txt"]
    assert path.read_text() == "whole"


def test_of_two_writers_the_last_wins_whole(tmp_path: Path) -> None:
    """Two that write one file at a time do not see each other's half."""
    path = tmp_path / "out.txt"
    with whole_text_file(path) as first:
        first.write("first, ")
        write_whole(path, "second")
        first.write("longer")
        assert path.read_text() == "second"
    assert path.read_text() == "first, longer"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("kind", ["device", "pipe", "folder", "loop"])
def test_what_is_no_file_is_not_replaced(tmp_path: Path, kind: str) -> None:
    """Renaming onto /dev/null would leave a plain file in its place."""
    path = Path("/dev/null") if kind == "device" else tmp_path / "out"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "loop":
        path.symlink_to(path)
    before = stat.S_IFMT(path.lstat().st_mode)
    with pytest.raises(InputError, match="expected a file, got a folder or device"):
        write_whole(path, "x")
    assert stat.S_IFMT(path.lstat().st_mode) == before


def test_links_and_permissions_stay(tmp_path: Path) -> None:
    """A link keeps pointing to the file that is replaced, which keeps who may read it."""
    (tmp_path / "there").mkdir()
    path, link = tmp_path / "there" / "out.txt", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_whole(link, "new")
    assert link.readlink() == path
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    link.unlink()
    link.symlink_to(tmp_path / "there" / "fresh.txt")
    write_whole(link, "new")
    assert (tmp_path / "there" / "fresh.txt").read_text() == "new"


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("absent/out.txt", "got No such file"),
        ("file/out.txt", "got Not a directory"),
        ("n" * 300, "got File name too long"),
    ],
)
def test_places_that_cannot_be_written(tmp_path: Path, place: str, reason: str) -> None:
    """One line names the path that was asked for, not the temporary one."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=reason) as caught:
        write_whole(tmp_path / place, "x")
    assert caught.value.path == str(tmp_path / place)
    assert [item.name for item in tmp_path.iterdir()] == ["file"]


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind root")
def test_what_may_not_be_written_is_refused(tmp_path: Path) -> None:
    """A read-only folder and a read-only file stay as they are."""
    path = tmp_path / "out.txt"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(InputError, match="read-only"):
        write_whole(path, "x")
    tmp_path.chmod(0o555)
    with pytest.raises(InputError, match="Permission denied"):
        write_whole(tmp_path / "new.txt", "x")
    tmp_path.chmod(0o755)
    assert path.read_text() == "old"


def test_a_file_system_that_takes_no_files_is_told(tmp_path: Path) -> None:
    """What the kernel shows as files refuses new ones even to root."""
    if not Path("/proc/self").is_dir():
        pytest.skip("needs a file system that nobody can write to")
    with pytest.raises(InputError, match="expected a path that can be written"):
        write_whole(Path("/proc/out.txt"), "x")


def test_a_full_disk_is_told_and_leaves_the_old_file(tmp_path: Path) -> None:
    """The limit on file sizes stands for a disk on which there is no more room."""
    path = tmp_path / "out.txt"
    path.write_text("old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(InputError, match="expected a path that can be written, got File too"):
            write_whole(path, "x" * 2000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_lost_with_the_power_is_not_put_in_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that fails while the content is forced to it leaves the old file."""
    path = tmp_path / "out.txt"
    path.write_text("old")

    def fail(_: int) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(InputError, match="Input/output error"):
        write_whole(path, "new")
    assert path.read_text() == "old"


def test_other_errors_are_not_taken_for_the_disk(tmp_path: Path) -> None:
    """A file that the writer wanted to read, and a mistake of its own, come out as they are."""
    with pytest.raises(FileNotFoundError, match="theirs"), whole_file(tmp_path / "out.txt"):
        (tmp_path / "theirs").read_text()
    with pytest.raises(BrokenPipeError), whole_file(tmp_path / "out.txt"):
        raise BrokenPipeError(errno.EPIPE, "Broken pipe")
    assert list(tmp_path.iterdir()) == []
