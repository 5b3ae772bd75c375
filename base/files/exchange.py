"""Two names exchanged in one step, so that at no instant either stands for nothing.

Linux has ``renameat2`` with ``RENAME_EXCHANGE`` for it, and macOS ``renamex_np`` with
``RENAME_SWAP``.  Some file systems refuse both, and Windows has no such call.
"""

import ctypes
import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path

# EPERM is what a container says of a call that it does not let through.
_UNKNOWN = {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EPERM}
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2  # linux/fcntl.h, linux/fs.h
_RENAME_SWAP = 2  # sys/stdio.h of macOS


def exchange(first: Path, second: Path) -> bool:
    """Let two names of one file system stand for each other's file or folder, in one step.

    Return False, with nothing changed, where the system or the file system cannot.

    Raises `OSError` if a name is missing or may not be changed.
    """
    call = _system_call()
    if call is None:
        return False
    ctypes.set_errno(0)
    if call(os.fsencode(first), os.fsencode(second)) == 0:
        return True
    number = ctypes.get_errno()
    if number in _UNKNOWN:
        return False
    raise OSError(number, os.strerror(number), os.fspath(first), None, os.fspath(second))


def _system_call() -> Callable[[bytes, bytes], int] | None:
    """Return what exchanges two paths and sets errno, or None where the C library has no such."""
    if sys.platform not in {"linux", "darwin"}:
        return None
    library = ctypes.CDLL(None, use_errno=True)
    if sys.platform == "darwin":
        swap = getattr(library, "renamex_np", None)
        return None if swap is None else lambda first, second: swap(first, second, _RENAME_SWAP)
    rename = getattr(library, "renameat2", None)
    if rename is None:
        return None
    return lambda a, b: rename(_AT_FDCWD, a, _AT_FDCWD, b, _RENAME_EXCHANGE)
