"""Text of a log file, whatever tool wrote it.

Logs are UTF-8 with or without a byte order mark, or UTF-16 with one: ``tool > log.csv`` in Windows
PowerShell makes UTF-16LE.  A second mark, left by a tool whose output was redirected, is skipped.
"""

import codecs
from pathlib import Path

from .errors import InputError

MAX_BYTES = 1 << 30
"""A million frames of the widest log read here are 0.4 GB."""

_UTF16 = {codecs.BOM_UTF16_LE: "UTF-16LE", codecs.BOM_UTF16_BE: "UTF-16BE"}
_MARK = "\ufeff"


def read_text(path: str | Path) -> str:
    """Return the text of a file, without byte order mark; line ends are left as they are.

    Raises `InputError` if the file cannot be read, is empty, exceeds `MAX_BYTES`, is binary, or is
    neither UTF-8 nor marked UTF-16; with the line where there is one.
    """
    return read_encoded(path)[0]


def read_encoded(path: str | Path) -> tuple[str, str]:
    """Return the text as `read_text` does, and the encoding it was in (``UTF-8``, ``UTF-16LE``…).

    Raises
    ------
    InputError
        As `read_text`.
    """
    data = _read_bytes(Path(path))
    encoding = _UTF16.get(data[:2], "UTF-8")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise InputError(
            f"expected {encoding} text, got byte 0x{data[error.start]:02x}; save the file as UTF-8",
            path=path,
            line=data.count(b"\n", 0, error.start) + 1,
        ) from error
    zero = text.find("\0")
    if zero >= 0:
        raise InputError(
            "expected text, got a zero byte: a binary file, or UTF-16 without byte order mark; "
            "save it as UTF-8",
            path=path,
            line=text.count("\n", 0, zero) + 1,
        )
    return text.lstrip(_MARK), encoding


def _read_bytes(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(
                f"expected at most {MAX_BYTES} bytes, got {size}; cut the log into parts", path=path
            )
        data = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the file name
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"expected a file that can be read, got {reason}; check the path", path=path
        ) from error
    if not data.strip():
        raise InputError("expected text, got an empty file; write it again", path=path)
    return data
