"""Files that are written whole or not at all."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from .errors import InputError


@contextmanager
def whole_file(path: Path) -> Generator[Path]:
    """Yield a temporary name beside `path`, and rename that file when all is written.

    Raises `InputError` if the file cannot be written, or `path` is a folder or a device, which a
    rename would replace; a file that was there before stays as it was.
    """
    if path.exists() and not path.is_file():
        raise InputError("expected a file, got a folder or device; name a file", path=path)
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        yield partial
        partial.replace(path)
    except OSError as error:
        raise InputError(
            f"expected a file that can be written, got {error.strerror or error}; check the folder",
            path=path,
        ) from error
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def whole_text_file(path: Path) -> Generator[TextIO]:
    """Open a UTF-8 file that is written as `whole_file` does, which may raise its errors."""
    with whole_file(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        yield file
