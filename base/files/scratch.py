"""A folder beside an output for what is not finished yet, removed at any exit.

Its name tells which machine made it, and a lock in it is held for as long as the process runs.  So
a later write to the same place removes what a killed run left there, and puts back what that run
had moved aside.
"""

import errno
import os
import platform
import re
import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import InputError
from .file_lock import NO_LOCKS, lock_file, unlock_file
from .folder_lock import sweep_locks

MOVED = "moved"
"""The folder in a scratch folder that holds, under its own name, what was moved aside."""

_LOCK = "lock"  # beside `NEW`, in which outputs have names of their own
NEW = "new"
"""The folder in a scratch folder that holds what is being written."""

_PREFIX = f".lodbench-{platform.node()}-"
_NAME = re.compile(rf"{re.escape(_PREFIX)}(\d{{1,9}})-\w+\.partial")
FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS}
"""Numbers of the errors by which a system says that a disk takes no more."""

_MISTAKES = {errno.ENOENT, errno.EEXIST}


@contextmanager
def scratch_beside(target: Path, shown: Path) -> Generator[Path]:
    """Yield a new folder beside `target`, on the same disk, and remove it afterwards.

    In it there is an empty folder `NEW`.

    Raises `InputError`, naming `shown`, if it cannot be made, the disk is full, or what the caller
    does in it is refused by the operating system.
    """
    scratch: Path | None = None
    lock: int | None = None
    try:
        sweep(target.parent)
        scratch, lock = _make_locked(target.parent)
        (scratch / NEW).mkdir()
        yield scratch
    except OSError as error:
        if scratch is None or _refuses_output(error, scratch):
            # Not the error's own text: libraries put theirs around the system's.
            got = os.strerror(error.errno) if error.errno else str(error)
            message = f"expected a path that can be written, got {got}; check the folder"
            raise InputError(message, path=shown) from error
        raise
    finally:
        if lock is not None:
            unlock_file(lock)  # first, as Windows removes no open file
        if scratch is not None:
            _discard(scratch)


def _make_locked(folder: Path) -> tuple[Path, int | None]:
    """Return a new scratch folder and the handle of its lock, None where there are no locks."""
    while True:
        scratch = Path(tempfile.mkdtemp(".partial", f"{_PREFIX}{os.getpid()}-", folder))
        try:
            return scratch, lock_file(scratch / _LOCK)
        except (BlockingIOError, FileNotFoundError):
            continue  # before it was locked, somebody took it for left behind, and removes it
        except OSError as error:
            if error.errno in NO_LOCKS:
                return scratch, None
            _discard(scratch)
            raise


def _refuses_output(error: OSError, scratch: Path) -> bool:
    """Whether the system refused to write here; the caller's other troubles are not about that."""
    names = (error.filename, error.filename2)
    inside = any(Path(str(name)).is_relative_to(scratch) for name in names)
    gone = not scratch.exists()
    return gone or error.errno in FULL or (inside and error.errno not in _MISTAKES)


def sweep(folder: Path) -> None:
    """Remove what processes of this machine that run no more left in a folder."""
    with suppress(OSError):  # a folder that is missing or cannot be listed has nothing to sweep
        for path in list(folder.iterdir()):
            if name := _NAME.fullmatch(path.name):
                _discard_left(path, int(name[1]))
        sweep_locks(folder)


def _discard_left(scratch: Path, process: int) -> None:
    """Remove a scratch folder that nobody holds; without a lock in it, if its process is gone."""
    try:
        lock = lock_file(scratch / _LOCK, create=False)
    except BlockingIOError:
        return
    except OSError:  # killed before there was one, or there are no locks on this file system
        if not _runs(process):
            _discard(scratch)
        return
    _discard(scratch)  # while it is held, so that who has just made it cannot lock it meanwhile
    unlock_file(lock)
    if os.name == "nt":
        _discard(scratch)  # where no open file is removed


def flush(path: Path) -> None:
    """Force a file, or a folder with all that is in it, to the disk."""
    if not path.is_dir():
        _flush_one(path, os.O_RDWR)
        return
    for inner in path.iterdir():
        flush(inner)
    flush_names(path)


def flush_names(folder: Path) -> None:
    """Force the names in a folder to the disk, where the system can: Windows opens no folders."""
    with suppress(OSError):
        _flush_one(folder, os.O_RDONLY)


def _flush_one(path: Path, mode: int) -> None:
    handle = os.open(path, mode)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _runs(process: int) -> bool:
    if os.name == "nt":
        return True  # signal 0 is Ctrl-C there; what is left stays
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it runs, as another user
        return True
    return True


def _discard(scratch: Path) -> None:
    moved = scratch / MOVED
    for path in moved.iterdir() if moved.is_dir() else ():
        home = scratch.parent / path.name
        if not home.exists():  # stopped between moving the old folder away and the new one in
            try:
                path.rename(home)
            except OSError:
                return  # it is all that is left of that folder
    shutil.rmtree(scratch, ignore_errors=True)
