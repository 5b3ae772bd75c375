"""Text of a file, whatever tool wrote it.

It is UTF-8 with or without a byte order mark, or UTF-16 with one: ``tool > log.csv`` in Windows
PowerShell makes UTF-16LE.  A second mark, left by a tool whose output was redirected, is skipped.
"""

import codecs
from pathlib import Path

from ..errors import InputError

MAX_BYTES = 1 << 30
"""A million frames of the widest log read here are 0.4 GB."""

_UTF16 = {codecs.BOM_UTF16_LE: "UTF-16LE", codecs.BOM_UTF16_BE: "UTF-16BE"}
_MARK = "\ufeff"


def read_text(path: str | Path, *, largest_bytes: int = MAX_BYTES, advice: str = "") -> str:
    """Return the text of a file, without byte order mark; line ends are left as they are.

    Raises `InputError` if the file cannot be read, is empty, too large, binary, or neither UTF-8
    nor marked UTF-16; with the line where there is one, and with `advice`, if given, on what to do.
    """
    return read_encoded(path, largest_bytes=largest_bytes, advice=advice)[0]


def read_encoded(
    path: str | Path, *, largest_bytes: int = MAX_BYTES, advice: str = ""
) -> tuple[str, str]:
    """Return the text, and its encoding (``UTF-8``, ``UTF-16LE``…); raises as `read_text`."""
    data = read_bytes(Path(path), largest_bytes, advice)
    encoding = _UTF16.get(data[:2], "UTF-8")
    advice = advice or "save the file as UTF-8"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise InputError(
            f"expected {encoding} text, got byte 0x{data[error.start]:02x}; {advice}",
            path=path,
            line=data.count(b"\n", 0, error.start) + 1,
        ) from error
    zero = text.find("\0")
    if zero >= 0:
        raise InputError(
            "expected text, got a zero byte: a binary file, or UTF-16 without byte order mark; "
            + advice,
            path=path,
            line=text.count("\n", 0, zero) + 1,
        )
    return text.lstrip(_MARK), encoding


def read_bytes(path: Path, largest_bytes: int, advice: str = "") -> bytes:
    """Return the content of a file; raises `InputError` if it is missing, empty or too large."""
    try:
        size = path.stat().st_size
        if size > largest_bytes:
            message = f"expected at most {largest_bytes} bytes, got {size}; name another file"
            raise InputError(message, path=path)
        data = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the file name
        reason = getattr(error, "strerror", None) or error
        message = f"expected a file that can be read, got {reason}; {advice or 'check the path'}"
        raise InputError(message, path=path) from error
    if not data.strip():
        message = f"expected text, got an empty file; {advice or 'write it again'}"
        raise InputError(message, path=path)
    return data
