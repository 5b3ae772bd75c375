"""Folders that are written whole or not at all."""

import os
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from .errors import InputError


def require_own(folder: Path, foreign: list[str], command: str) -> None:
    """Raise InputError if a folder, which would be replaced, holds files of somebody else."""
    if foreign:
        raise InputError(
            f"expected a new folder or one that `lodbench {command}` wrote, got one that holds "
            f"{foreign[0]}; name another",
            path=folder,
        )


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

    What was there before is lost only then.
    """
    parent = folder.absolute().parent
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=parent) as scratch:
        partial, before = Path(scratch) / "new", Path(scratch) / "old"
        partial.mkdir()
        yield partial
        if folder.exists():
            folder.rename(before)
        try:
            partial.rename(folder)
        except BaseException:
            if before.exists():
                before.rename(folder)
            raise
