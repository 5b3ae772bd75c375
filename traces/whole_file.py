"""Files that are written whole or not at all."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from ..errors import InputError

__all__ = ["whole_text_file"]


@contextmanager
def whole_text_file(path: Path) -> Generator[TextIO]:
    """Open a UTF-8 file under a temporary name beside `path`, and rename it when all is written.

    Raises
    ------
    InputError
        If the file cannot be written; one that was there before stays as it was.
    """
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("w", encoding="utf-8", newline="") as file:
            yield file
        partial.replace(path)
    except OSError as error:
        raise InputError(
            f"expected a file that can be written, got {error.strerror or error}; check the folder",
            path=path,
        ) from error
    finally:
        partial.unlink(missing_ok=True)
