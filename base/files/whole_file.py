"""Files that are written whole or not at all."""

import os
import shutil
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from ..errors import InputError
from .scratch import NEW, flush, flush_names, scratch_beside


@contextmanager
def whole_file(path: Path) -> Generator[Path]:
    """Yield a temporary name of the same suffix, and put that file in place when all is written.

    A file that was there before stays as it was until then, and its permissions stay; a symbolic
    link keeps pointing where it does.

    Raises `InputError` if the file cannot be written, or `path` is a folder, a pipe or a device,
    which a rename would replace.
    """
    target = Path(os.path.realpath(path))
    # Where a name is too long or may not be looked up, pathlib raises; here the writer meets the
    # same error, and it is told in one line.
    replaces = os.path.isfile(target)  # noqa: PTH113
    if os.path.lexists(target) and not replaces:  # a link here is one of a loop of links
        raise InputError("expected a file, got a folder or device; name a file", path=path)
    if replaces and not os.access(target, os.W_OK):
        message = "expected a file that can be written, got a read-only one; name another"
        raise InputError(message, path=path)
    with scratch_beside(target, path) as scratch:
        partial = scratch / NEW / target.name
        yield partial
        flush(partial)
        if replaces and target.exists():
            shutil.copymode(target, partial)
        partial.replace(target)
        flush_names(target.parent)


@contextmanager
def whole_text_file(path: Path) -> Generator[TextIO]:
    """Open a UTF-8 file that is written as `whole_file` does, which may raise its errors."""
    with whole_file(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        yield file


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file as `whole_file` does, which may raise its errors; text becomes UTF-8."""
    with whole_file(path) as partial:
        partial.write_bytes(content.encode() if isinstance(content, str) else content)
