"""Locks on files that the system frees when their process ends, whatever ends it.

They are advisory: they bind those who ask for them.
"""

import errno
import os
import sys
from contextlib import suppress
from pathlib import Path

NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EINVAL}
"""Numbers of the errors by which a file system says that it has no locks."""

_held: set[int] = set()


def lock_file(path: Path, *, create: bool = True) -> int:
    """Lock a file for this process, and return the handle that `unlock_file` takes.

    Raises `BlockingIOError` if another handle holds the lock, and another `OSError` if the file
    cannot be opened or its file system has no locks (`NO_LOCKS`).
    """
    # A link that somebody put in its place would have us write into the file that it leads to.
    mode = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | (os.O_CREAT if create else 0)
    while True:
        handle = os.open(path, mode, 0o666)
        try:
            _lock(handle)
            if _stands(handle, path):
                _held.add(handle)
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)  # who held it before removed the file: the lock is of another one


def holds(handle: int) -> bool:
    """Whether a lock is this process's: what is forked off a process holds none of its locks."""
    return handle in _held


def unlock_file(handle: int) -> None:
    """Free a lock of this process; one that it does not hold is left alone."""
    if handle in _held:
        _held.remove(handle)
        os.close(handle)


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        # A locked byte cannot be read there, so it is one behind whatever the file says.
        os.lseek(handle, 1 << 30, os.SEEK_SET)
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError as error:
            raise BlockingIOError(errno.EWOULDBLOCK, "locked") from error
        os.lseek(handle, 0, os.SEEK_SET)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _stands(handle: int, path: Path) -> bool:
    """Whether the path still leads to the file that was opened."""
    with suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(handle), path.lstat())
    return False


def _close_copies() -> None:
    """Close the copies that a fork makes of handles, by which a lock would outlive its process."""
    for handle in _held:
        os.close(handle)
    _held.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_close_copies)
