"""A lock on a folder that is being written, which names who writes it.

It is a file beside the folder, ``.lodbench-NAME.lock``, locked by the process that writes.  The
system frees that lock whatever ends the process, so that it is never stale; the next write beside
it removes a file that a killed process left.
"""

import errno
import hashlib
import os
import platform
import re
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from datetime import UTC, datetime
from pathlib import Path

from ..errors import InputError
from .file_lock import NO_LOCKS, holds, lock_file, unlock_file

_LONGEST_NAME_BYTES = 200  # of 255 that file systems allow
_TRIES = 10  # while others sweep the lock, or remove a folder that was made for it
_PAUSE_S = 0.01
_HOLDER = re.compile(r"process \d+ on [\w.-]+ writes since [\d:-]+ [\d:]+ UTC")

_mine: ContextVar[frozenset[Path]] = ContextVar(
    "folders that the caller holds", default=frozenset()
)


@contextmanager
def locked(folder: Path, *, make_parents: bool = False) -> Generator[None]:
    """Hold a folder, which need not be there yet, as its one writer until the block ends.

    A block within another of the same thread that holds the folder already holds it too.  On a file
    system without locks nobody is kept away.

    Parameters
    ----------
    make_parents
        Make the folders above that are missing, and remove them afterwards if they are empty.

    Raises `InputError` if somebody else holds the folder, or there is no place for the lock.
    """
    target = Path(os.path.realpath(folder))
    if target in _mine.get():
        yield
        return
    made: list[Path] = []
    try:
        handle, path = _take(target, folder, made if make_parents else None)
        held = _mine.set(_mine.get() | {target})
        try:
            yield
        finally:
            _mine.reset(held)
            _give_back(handle, path)
    finally:
        for parent in reversed(made):
            with suppress(OSError):  # it is not empty
                parent.rmdir()


def lock_path(folder: Path) -> Path:
    """Return the file that is locked by who writes a folder."""
    name = os.fsencode(folder.name)
    shown = folder.name if len(name) <= _LONGEST_NAME_BYTES else hashlib.sha256(name).hexdigest()
    return folder.with_name(f".lodbench-{shown}.lock")


def sweep_locks(folder: Path) -> None:
    """Remove the files that killed writers left in a folder; raises `OSError` as listing it."""
    for path in list(folder.glob(".lodbench-*.lock")):
        with suppress(OSError):  # it is held, or not ours to remove
            _give_back(lock_file(path, create=False), path)


def _take(target: Path, shown: Path, made: list[Path] | None) -> tuple[int | None, Path]:
    """Return the handle of the lock, None if there are no locks here, and its file."""
    path = lock_path(target)
    for left in reversed(range(_TRIES)):
        try:
            if made is not None:
                _make_folders(target.parent, made)
            handle = lock_file(path)
        except BlockingIOError as error:
            if left == 0:
                raise InputError(
                    f"expected a folder that nobody writes to, got one that {_holder(path)}; "
                    "wait for it or name another",
                    path=shown,
                ) from error
        except OSError as error:
            if error.errno in NO_LOCKS:
                break
            if made is None or error.errno != errno.ENOENT or left == 0:
                raise _no_place(error, shown) from error
        else:
            _sign(handle)
            return handle, path
        time.sleep(_PAUSE_S)
    return None, path


def _make_folders(folder: Path, made: list[Path]) -> None:
    """Make a folder and those above it, and note which were not there."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    for path in reversed(missing):
        with suppress(FileExistsError):
            path.mkdir()
            made.append(path)


def _no_place(error: OSError, shown: Path) -> InputError:
    return InputError(
        "expected a folder beside which a lock can be written, got "
        f"{error.strerror or error}; name another",
        path=shown,
    )


def _sign(handle: int) -> None:
    """Write who holds the lock into its file, as far as there is room on the disk."""
    host = re.sub(r"[^\w.-]", "_", platform.node()) or "this machine"
    since = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S")
    with suppress(OSError):
        os.ftruncate(handle, 0)
        os.write(handle, f"process {os.getpid()} on {host} writes since {since} UTC\n".encode())


def _holder(path: Path) -> str:
    """Return who holds a lock, as its file says; it may just be taken or given back."""
    with suppress(OSError, UnicodeError), path.open(encoding="utf-8") as file:
        text = file.read(500).strip()
        if _HOLDER.fullmatch(text):
            return text
    return "another process writes"


def _give_back(handle: int | None, path: Path) -> None:
    if handle is None or not holds(handle):
        return
    with suppress(OSError):  # Windows removes no open file; an empty one stays there
        path.unlink()
    unlock_file(handle)
