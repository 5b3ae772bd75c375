"""Lines and numbers of a text file, with errors that name the file and the line."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..errors import InputError

__all__ = ["data_lines", "parse_numbers", "read_bytes", "read_lines"]

# An hour at 1,000 Hz in the widest format that is read here is 0.7 GB.
MAX_BYTES = 1 << 30


def read_bytes(path: Path, limit: int = -1) -> bytes:
    """Content of a file, or its first ``limit`` bytes.

    Raises
    ------
    InputError
        If it cannot be read, is empty, or is larger than 1 GiB.
    """
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(
                f"expected at most {MAX_BYTES} bytes, got {size}; cut the trace into parts",
                path=path,
            )
        with path.open("rb") as file:
            data = file.read(limit)
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the file name
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"expected a file that can be read, got {reason}; check the path", path=path
        ) from error
    if not data:
        raise InputError("expected a camera trace, got an empty file", path=path)
    return data


def read_lines(path: Path) -> list[str]:
    """Lines of a UTF-8 text file (a byte order mark is skipped), without their ends.

    Raises
    ------
    InputError
        As `read_bytes`, or if the file is binary or not UTF-8.
    """
    data = read_bytes(path)
    zero = data.find(b"\0")
    if zero >= 0:
        raise InputError(
            "expected text, got a zero byte: this is a binary or UTF-16 file; save it as UTF-8",
            path=path,
            line=data.count(b"\n", 0, zero) + 1,
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"expected UTF-8 text, got byte 0x{data[error.start]:02x}; save the file as UTF-8",
            path=path,
            line=data.count(b"\n", 0, error.start) + 1,
        ) from error
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def data_lines(path: Path) -> Iterator[tuple[int, str]]:
    """1-based number and text of each line that is neither blank nor a ``#`` comment."""
    for number, line in enumerate(read_lines(path), start=1):
        text = line.strip()
        if text and not text.startswith("#"):
            yield number, text


def parse_numbers(
    fields: Sequence[str], names: Sequence[str], *, path: Path, line: int
) -> list[float]:
    """Finite numbers of one row, one for each column name.

    Raises
    ------
    InputError
        If the row has more or fewer columns, or one is not a finite number.
    """
    if len(fields) != len(names):
        raise InputError(
            f"expected {len(names)} columns ({' '.join(names)}), got {len(fields)}; "
            "complete or remove the row",
            path=path,
            line=line,
        )
    try:
        numbers = list(map(float, fields))
    except ValueError:
        numbers = [math.nan]
    if not all(map(math.isfinite, numbers)):
        name, field = next(pair for pair in zip(names, fields, strict=True) if not _finite(pair[1]))
        raise InputError(
            f"expected a finite number for {name}, got {field[:40]!r}; correct or remove the row",
            path=path,
            line=line,
        )
    return numbers


def _finite(field: str) -> bool:
    try:
        return math.isfinite(float(field))
    except ValueError:
        return False
