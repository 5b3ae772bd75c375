"""Folders that are written whole or not at all."""

import errno
import os
import re
import shutil
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import InputError
from .scratch import MOVED, flush, flush_names, scratch_beside, sweep


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
    target = Path(os.path.realpath(folder))
    if not target.name or target == Path.cwd():
        message = "expected a folder of its own to write to, got this one; name another"
        raise InputError(message, path=folder)
    if os.path.lexists(target):
        _require_own(folder, ours, command)
    parents = (parent for parent in target.parents if parent.exists() or not make_parents)
    require_writable(next(parents))


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


def _names(folder: Path) -> Iterator[str]:
    inner = sorted(folder.iterdir())
    yield from (path.name for path in inner)
    for path in inner:
        if path.is_dir():
            yield from sorted(f"{path.name}/{below.name}" for below in path.iterdir())


def require_writable(folder: Path) -> None:
    """Raise InputError before the work if nothing could be written to a folder after it."""
    if not (folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)):
        raise InputError(
            "expected a folder that can be written to, got one that cannot; name another",
            path=folder,
        )


@contextmanager
def whole_folder(folder: Path) -> Generator[Path]:
    """Yield a new folder beside `folder`, and put it in place of that when all is written.

    What was there before is lost only then; see `require_replaceable`.

    Raises `InputError` if the folder cannot be written.
    """
    target = Path(os.path.realpath(folder))
    with scratch_beside(target, folder) as scratch:
        partial, moved = scratch / "new", scratch / MOVED
        partial.mkdir()
        yield partial
        flush(partial)
        _exchange(partial, target, moved)
        flush_names(target.parent)


def _exchange(new: Path, target: Path, moved: Path) -> None:
    """Rename `new` to `target`; what was there stands in `moved`, from where an error restores it.

    There is no portable way to do both in one step, so another writer's folder may come between:
    it is moved away too, and the last writer wins.
    """
    while True:
        shutil.rmtree(moved, ignore_errors=True)
        moved.mkdir()
        with suppress(FileNotFoundError):
            target.rename(moved / target.name)
        try:
            new.rename(target)
        except OSError as error:
            if error.errno not in {errno.EEXIST, errno.ENOTEMPTY}:
                raise
        else:
            return
