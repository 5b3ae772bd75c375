"""Two names exchanged in one step."""

import errno
import sys
from pathlib import Path

import pytest

from lodbench.base.files import exchange as module
from lodbench.base.files.exchange import exchange

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="the call is Linux's")


@LINUX
def test_folders_change_places(tmp_path: Path) -> None:
    """Each name stands for what the other stood for, whatever is in it and in whichever folder."""
    first, second = tmp_path / "first", tmp_path / "below" / "zweiter Ordner ü"
    for folder in (first, second):
        folder.mkdir(parents=True)
        (folder / folder.name).write_text("", encoding="utf-8")
    assert exchange(first, second)
    assert [path.name for path in first.iterdir()] == [second.name]
    assert [path.name for path in second.iterdir()] == [first.name]


@LINUX
def test_a_missing_name_is_told_and_nothing_changes(tmp_path: Path) -> None:
    """Without the second there is nothing to exchange, and the first stays."""
    first = tmp_path / "first"
    first.mkdir()
    with pytest.raises(FileNotFoundError) as caught:
        exchange(first, tmp_path / "absent")
    assert caught.value.filename2 == str(tmp_path / "absent")
    assert list(tmp_path.iterdir()) == [first]


@pytest.mark.parametrize(
    "number", [errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EPERM, errno.ENOSPC]
)
def test_a_file_system_without_it_is_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    """What the kernel says of a call that it does not know is told from a full disk."""

    def refuse(_: bytes, __: bytes) -> int:
        module.ctypes.set_errno(number)
        return -1

    monkeypatch.setattr(module, "_system_call", lambda: refuse)
    if number == errno.ENOSPC:
        with pytest.raises(OSError, match="No space left"):
            exchange(tmp_path / "first", tmp_path / "second")
    else:
        assert not exchange(tmp_path / "first", tmp_path / "second")


def test_a_system_without_it_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows has no such call, whether the names are there or not."""
    monkeypatch.setattr(module.sys, "platform", "win32")
    assert not exchange(tmp_path / "first", tmp_path / "second")
