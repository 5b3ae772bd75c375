"""Folders that are written whole or not at all."""

import errno
import os
import re
import shutil
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import InputError
from .exchange import exchange
from .folder_lock import locked
from .scratch import MOVED, NEW, flush, flush_names, scratch_beside, sweep
from .writable import found_above, require_movable, require_writable, stands


def require_replaceable(
    folder: Path, ours: str, command: str, *, make_parents: bool = False
) -> None:
    """Refuse, before the work, a folder that `whole_folder` must not or cannot replace.

    Raises `InputError` if it is a file or the current folder, holds files of somebody else, which
    would be lost, or could not be written.

    Parameters
    ----------
    ours
        A regular expression of the names in the folder that `command` writes; those one level down
        are ``folder/name``.
    """
    try:
        target, here = Path(os.path.realpath(folder)), Path.cwd()
    except OSError as error:  # the current folder is gone
        message = f"expected a folder to write to, got {error.strerror}; change to another folder"
        raise InputError(message, path=folder) from error
    if not target.name or target == here:
        message = "expected a folder of its own to write to, got this one; name another"
        raise InputError(message, path=folder)
    sweep(target.parent)
    if os.path.ismount(target):
        message = "expected a folder that can be replaced, got a mount; name a folder in it"
        raise InputError(message, path=folder)
    if stands(target, folder):
        _require_own(folder, ours, command)
    require_writable(found_above(target) if make_parents else target.parent)


def _require_own(folder: Path, ours: str, command: str) -> None:
    if not folder.is_dir():
        raise InputError("expected a folder to write to, got a file; name a folder", path=folder)
    sweep(folder)
    foreign = next((name for name in _names(folder) if not re.fullmatch(ours, name)), None)
    if foreign is not None:
        raise InputError(
            f"expected a new folder or one that `lodbench {command}` wrote, got one that holds "
            f"{foreign}; name another",
            path=folder,
        )
    require_movable(folder)


def _names(folder: Path) -> Iterator[str]:
    """Yield the names in a folder and those one level down, in folders that can be emptied."""
    require_writable(folder)
    inner = sorted(folder.iterdir())
    yield from (path.name for path in inner)
    for path in inner:
        if path.is_dir():
            require_writable(path)
            yield from sorted(f"{path.name}/{below.name}" for below in path.iterdir())


@contextmanager
def claimed_folder(
    folder: Path, ours: str, command: str, *, make_parents: bool = False
) -> Generator[None]:
    """Hold a folder from before the work until its result is in place, as its one writer.

    The block does the work, and writes with `whole_folder`.  Parameters are those of
    `require_replaceable`; `make_parents` makes missing folders above.

    Raises `InputError` as `require_replaceable`, or if another process writes to the folder.
    """
    require_replaceable(folder, ours, command, make_parents=make_parents)
    with locked(folder, make_parents=make_parents):
        yield


@contextmanager
def whole_folder(folder: Path) -> Generator[Path]:
    """Yield a new folder beside `folder`, and put it in place of that when all is written.

    What was there before is lost only then, in one step where the system has one (`exchange`); see
    `require_replaceable`.

    Raises `InputError` if the folder cannot be written, or another process writes to it.
    """
    target = Path(os.path.realpath(folder))
    with locked(folder), scratch_beside(target, folder) as scratch:
        with _about(folder, scratch / NEW):
            yield scratch / NEW
        flush(scratch / NEW)
        _put_in_place(scratch / NEW, target, scratch / MOVED)
        flush_names(target.parent)


@contextmanager
def _about(folder: Path, partial: Path) -> Generator[None]:
    """Name a file by where it would be, in what is told of one that could not be written."""
    try:
        yield
    except InputError as error:
        if error.path is None or not Path(error.path).is_relative_to(partial):
            raise
        path = folder / Path(error.path).relative_to(partial)
        raise InputError(error.message, path=path, line=error.line) from error


def _put_in_place(new: Path, target: Path, moved: Path) -> None:
    """Let `new` be `target`, from whichever of the two names what was there before is removed.

    Without an exchange in one step the old folder stands in `moved` for an instant, from where an
    error, or the next write beside it, brings it back.  Another writer's folder that comes between,
    which only a file system without locks allows, is replaced too: the last writer wins.
    """
    while True:
        with suppress(FileNotFoundError):  # there is no old folder
            if exchange(new, target):
                return
            shutil.rmtree(moved, ignore_errors=True)
            moved.mkdir()
            target.rename(moved / target.name)
        try:
            new.rename(target)  # which replaces no folder that holds anything
        except OSError as error:
            if error.errno not in {errno.EEXIST, errno.ENOTEMPTY}:
                raise
        else:
            return
