"""Whether a place can be written to, asked before the work whose result is to go there."""

import os
import stat
from pathlib import Path

from ..errors import InputError


def require_writable(folder: Path) -> None:
    """Raise InputError before the work if nothing could be written to a folder after it."""
    # `Path.is_dir` raises where the folder above may not be looked into.
    is_folder = os.path.isdir(folder)  # noqa: PTH112
    if not (is_folder and os.access(folder, os.R_OK | os.W_OK | os.X_OK)):
        raise InputError(
            "expected a folder that can be written to, got one that cannot; name another",
            path=folder,
        )


def require_movable(path: Path) -> None:
    """Raise InputError if a file or folder is another user's where each moves only his own.

    As in ``/tmp``, whose sticky bit says so.
    """
    if os.name == "nt":
        return
    above, me = path.parent.stat(), os.geteuid()
    if above.st_mode & stat.S_ISVTX and me not in {0, above.st_uid, path.stat().st_uid}:
        message = "expected a place of one's own, got another user's; name another"
        raise InputError(message, path=path)


def require_file_writable(path: Path, *, make_parents: bool = False) -> None:
    """Raise InputError before the work if `whole_file` could not write a file after it.

    Parameters
    ----------
    make_parents
        Folders above that are missing will be made.
    """
    target = Path(os.path.realpath(path))
    require_writable(found_above(target) if make_parents else target.parent)
    if not stands(target, path):
        return
    if not target.is_file():
        raise InputError("expected a file, got a folder or device; name a file", path=path)
    if not os.access(target, os.W_OK):
        message = "expected a file that can be written, got a read-only one; name another"
        raise InputError(message, path=path)
    require_movable(target)


def stands(target: Path, shown: Path) -> bool:
    """Whether there is anything at a path.

    Raises `InputError`, naming `shown`, if it cannot be looked up, as a name that is too long.
    """
    try:
        target.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        message = f"expected a path that can be written, got {error.strerror}; check the folder"
        raise InputError(message, path=shown) from error
    return True


def found_above(path: Path) -> Path:
    """Return the nearest of the folders above a path that is there, or stands in the way."""
    return next(parent for parent in path.parents if os.path.lexists(parent))
