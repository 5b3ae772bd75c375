"""Folders appear whole, or what was there before stays."""

import platform
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files import whole_folder as module
from lodbench.base.files.whole_file import write_whole
from lodbench.base.files.whole_folder import claimed_folder, require_replaceable, whole_folder

OURS = r"table\.csv|frames(/.*\.png)?"


@pytest.fixture
def no_exchange(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave two renames as the only way, as on a file system that exchanges nothing."""

    def refuse(*_: Path) -> bool:
        return False

    monkeypatch.setattr(module, "exchange", refuse)


def fill(folder: Path, name: str) -> None:
    """Write a folder with one file."""
    with whole_folder(folder) as partial:
        (partial / name).write_text(name, encoding="utf-8")


def test_a_folder_takes_the_place_of_the_one_before(tmp_path: Path) -> None:
    """Only what was written now is there, and nothing is left beside it."""
    folder = tmp_path / "run"
    for name in ("first", "second"):
        fill(folder, name)
    assert [path.name for path in folder.iterdir()] == ["second"]
    assert list(tmp_path.iterdir()) == [folder]


def test_a_failure_leaves_what_was_there(tmp_path: Path) -> None:
    """Work that fails, or a folder that cannot be put in place, loses nothing."""
    folder = tmp_path / "run"
    fill(folder, "first")
    with pytest.raises(FileNotFoundError), whole_folder(folder) as partial:
        (partial / "no" / "second").write_text("second", encoding="utf-8")
    with pytest.raises(FileNotFoundError), whole_folder(folder) as partial:
        partial.rename(tmp_path / "elsewhere")
    assert [path.name for path in folder.iterdir()] == ["first"]


@pytest.mark.usefixtures("no_exchange")
def test_without_an_exchange_two_renames_do(tmp_path: Path) -> None:
    """The old folder is moved away and the new one in, and nothing is left."""
    folder = tmp_path / "run"
    for name in ("first", "second"):
        fill(folder, name)
    assert [path.name for path in folder.iterdir()] == ["second"]
    assert list(tmp_path.iterdir()) == [folder]


@pytest.mark.usefixtures("no_exchange")
@pytest.mark.parametrize("interruption", [KeyboardInterrupt, SystemExit])
def test_an_interrupted_exchange_brings_the_folder_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, interruption: type[BaseException]
) -> None:
    """Ctrl-C between moving the old folder away and the new one in loses nothing."""
    folder = tmp_path / "run"
    fill(folder, "first")
    rename = Path.rename

    def interrupt_new(self: Path, target: Path) -> Path:
        if self.name == "new":
            raise interruption
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", interrupt_new)
    with pytest.raises(interruption):
        fill(folder, "second")
    assert [path.name for path in folder.iterdir()] == ["first"]
    assert list(tmp_path.iterdir()) == [folder]


def test_the_next_write_brings_back_what_a_killed_run_moved_away(tmp_path: Path) -> None:
    """Killed between the two renames, the old folder is found again by any write beside it."""
    folder = tmp_path / "run"
    fill(folder, "first")
    code = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from lodbench.base.files import whole_folder\n"
        "rename = Path.rename\n"
        "def kill(self, target):\n"
        "    if self.name == 'new':\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
        "    return rename(self, target)\n"
        "Path.rename = kill\n"
        "whole_folder.exchange = lambda *_: False\n"
        "with whole_folder.whole_folder(Path(sys.argv[1])):\n"
        "    pass\n"
    )
    killed = subprocess.run([sys.executable, "-c", code, str(folder)], check=False).returncode
    assert killed == -signal.SIGKILL
    assert not folder.exists()
    write_whole(tmp_path / "notes.txt", "x")
    assert (folder / "first").read_text(encoding="utf-8") == "first"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes.txt", "run"]


def test_a_second_writer_is_refused_before_its_work(tmp_path: Path) -> None:
    """From the check on the folder is held, so that neither of two runs is lost."""
    folder = tmp_path / "run"
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from lodbench.base.errors import InputError\n"
        "from lodbench.base.files.whole_folder import claimed_folder\n"
        "try:\n"
        "    with claimed_folder(Path(sys.argv[1]), 'first', 'record'):\n"
        "        print('begins its work')\n"
        "except InputError as error:\n"
        "    print(error)\n"
    )
    command = [sys.executable, "-c", code, str(folder)]
    with claimed_folder(folder, "first", "record"):
        second = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        fill(folder, "first")
    assert "expected a folder that nobody writes to, got one that process" in second
    assert [path.name for path in folder.iterdir()] == ["first"]
    assert list(tmp_path.iterdir()) == [folder]


@pytest.mark.usefixtures("no_exchange")
def test_without_locks_the_last_of_two_writers_wins_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder that another writer puts in place between the two renames is replaced too."""
    folder = tmp_path / "run"
    fill(folder, "first")
    rename = Path.rename

    def write_between(self: Path, target: Path) -> Path:
        if self.name == "new":
            monkeypatch.setattr(Path, "rename", rename)
            fill(folder, "second")  # within the lock of the third
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", write_between)
    fill(folder, "third")
    assert [path.name for path in folder.iterdir()] == ["third"]
    assert list(tmp_path.iterdir()) == [folder]


def test_a_link_keeps_pointing_to_the_folder(tmp_path: Path) -> None:
    """The folder behind a link is replaced, not the link."""
    fill(tmp_path / "run", "first")
    (tmp_path / "link").symlink_to("run")
    fill(tmp_path / "link", "second")
    assert (tmp_path / "link").is_symlink()
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["second"]


@pytest.mark.parametrize(
    ("names", "foreign"),
    [
        ((), None),
        (("table.csv", "frames/1.png"), None),
        (("table.csv", "notes.txt"), "notes.txt"),
        (("frames/notes.txt",), "frames/notes.txt"),
        (("other/1.png",), "other"),
    ],
)
def test_only_what_the_command_wrote_is_replaced(
    tmp_path: Path, names: tuple[str, ...], foreign: str | None
) -> None:
    """A folder with one file of somebody else is refused by its name."""
    folder = tmp_path / "run"
    folder.mkdir()
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text("", encoding="utf-8")
    if foreign is None:
        require_replaceable(folder, OURS, "record")
        return
    with pytest.raises(InputError, match=f"`lodbench record` wrote, got one that holds {foreign};"):
        require_replaceable(folder, OURS, "record")


def test_places_for_no_folder_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file, the current folder, and a folder in one that is not there."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for place, message in (
        (tmp_path / "file", "got a file"),
        (Path(), "got this one"),
        (tmp_path / "here", "got this one"),
        (tmp_path / "file" / "run", "expected a folder that can be written to"),
        (tmp_path / "absent" / "run", "expected a folder that can be written to"),
    ):
        with pytest.raises(InputError, match=message):
            require_replaceable(place, OURS, "record")
    require_replaceable(tmp_path / "absent" / "run", OURS, "record", make_parents=True)


def test_a_mount_cannot_be_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A volume that a container mounts is told before the work, in which it could not be moved."""
    monkeypatch.setattr("os.path.ismount", lambda path: Path(path) == tmp_path)  # pyright: ignore[reportUnknownLambdaType, reportUnknownArgumentType]
    with pytest.raises(InputError, match="got a mount; name a folder in it"):
        require_replaceable(tmp_path, OURS, "record")
    require_replaceable(tmp_path / "run", OURS, "record")


def test_without_a_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Somebody removed the folder from which the command runs."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "here").rmdir()
    with pytest.raises(InputError, match="got No such file or directory; change to another"):
        require_replaceable(Path("run"), OURS, "record")


@pytest.mark.parametrize("what", ["scratch", "everything"])
def test_a_folder_that_vanishes_meanwhile_is_told(tmp_path: Path, what: str) -> None:
    """Somebody tidies up while it is being written: one line, and no leftovers."""
    parent = tmp_path / "results"
    parent.mkdir()

    def write() -> None:
        with whole_folder(parent / "run") as partial:
            shutil.rmtree(partial.parent if what == "scratch" else parent)
            (partial / "table.csv").write_text("", encoding="utf-8")

    with pytest.raises(InputError, match="expected a path that can be written, got No such file"):
        write()
    assert not list(parent.iterdir()) if what == "scratch" else not parent.exists()


def test_what_a_killed_rewrite_left_inside_is_not_foreign(tmp_path: Path) -> None:
    """A report that was being rewritten in the folder leaves no reason to refuse it."""
    process = subprocess.run(
        [sys.executable, "-c", "import os; print(os.getpid())"],
        capture_output=True,
        text=True,
        check=True,
    )
    dead, folder = process.stdout.strip(), tmp_path / "run"
    left = folder / f".lodbench-{platform.node()}-{dead}-abc.partial"
    left.mkdir(parents=True)
    require_replaceable(folder, OURS, "record")
    assert not left.exists()
