"""Places that cannot be written to are known before the work."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files.writable import require_file_writable, require_movable, require_writable

ASK = (
    "import sys\n"
    "from pathlib import Path\n"
    "from lodbench.base.files import writable\n"
    "from lodbench.base.errors import InputError\n"
    "try:\n"
    "    getattr(writable, sys.argv[1])(Path(sys.argv[2]))\n"
    "    print('free')\n"
    "except InputError as error:\n"
    "    print(error.message)\n"
)


def be_bound_by_permissions() -> None:
    """Drop what lets root pass them, which is the same to another user."""
    if sys.platform == "linux" and os.geteuid() == 0:
        for capability in (1, 2, 3):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH, CAP_FOWNER
            ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


def asked(function: str, path: Path) -> str:
    """Return what a process says of a path that permissions bind."""
    command = [sys.executable, "-c", ASK, function, str(path)]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=True,
        preexec_fn=be_bound_by_permissions,
    ).stdout.strip()


@pytest.mark.skipif(sys.platform != "linux", reason="root is bound by permissions on Linux alone")
def test_permissions_are_looked_at(tmp_path: Path) -> None:
    """A folder without the bit for writing, a file in it, and a read-only file in a good one."""
    shut, file = tmp_path / "shut", tmp_path / "file"
    shut.mkdir()
    file.touch()
    assert asked("require_writable", shut) == "free"
    shut.chmod(0o555)
    file.chmod(0o444)
    assert "expected a folder that can be written to" in asked("require_writable", shut)
    assert "expected a folder that can be" in asked("require_file_writable", shut / "new")
    assert "expected a file that can be written, got a read-only" in asked(
        "require_file_writable", file
    )
    shut.chmod(0o000)
    assert "expected a folder that can be" in asked("require_file_writable", shut / "a" / "new")


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("file/new", "expected a folder that can be written to"),
        ("absent/new", "expected a folder that can be written to"),
        ("folder", "got a folder or device"),
        ("pipe", "got a folder or device"),
        ("loop", "got a folder or device"),
        ("n" * 300, "got File name too long"),
        ("/dev/null", "got a folder or device"),
    ],
)
def test_places_for_no_file(tmp_path: Path, place: str, message: str) -> None:
    """What `whole_file` refuses after the work is refused before it."""
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match=message):
        require_file_writable(tmp_path / place)


def test_places_for_a_file(tmp_path: Path) -> None:
    """A new one, one that is there, one behind a link that leads nowhere, one below new folders."""
    (tmp_path / "there").touch()
    (tmp_path / "link").symlink_to(tmp_path / "new")
    for name in ("new", "there", "link"):
        require_file_writable(tmp_path / name)
    require_file_writable(tmp_path / "a" / "b" / "new", make_parents=True)
    require_writable(tmp_path)
    with pytest.raises(InputError, match="there: expected a folder that can be written to"):
        require_file_writable(tmp_path / "there" / "b" / "new", make_parents=True)


def test_another_users_in_a_common_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the sticky bit is set, each moves his own, and root moves everything."""
    theirs, owner = tmp_path / "theirs", os.geteuid()
    theirs.mkdir()
    for bits, me, refused in (
        (0o1777, owner, False),
        (0o1777, 0, False),
        (0o1777, owner + 1, True),
        (0o777, owner + 1, False),
    ):
        tmp_path.chmod(bits)
        monkeypatch.setattr(os, "geteuid", lambda me=me: me)
        if refused:
            with pytest.raises(InputError, match="got another user's; name another"):
                require_movable(theirs)
        else:
            require_movable(theirs)
