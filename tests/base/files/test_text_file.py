"""Encodings in which tools leave their logs."""

import os
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files.text_file import MAX_BYTES, read_encoded, read_text

TEXT = "ms,µs\r\n1,2\n"


@pytest.mark.parametrize(
    ("data", "encoding"),
    [
        (TEXT.encode(), "UTF-8"),
        (b"\xef\xbb\xbf" + TEXT.encode(), "UTF-8"),
        (b"\xff\xfe" + TEXT.encode("utf-16-le"), "UTF-16LE"),
        (b"\xfe\xff" + TEXT.encode("utf-16-be"), "UTF-16BE"),
        # A program that writes a mark of its own, redirected by PowerShell.
        (b"\xff\xfe" + ("\ufeff" + TEXT).encode("utf-16-le"), "UTF-16LE"),
    ],
)
def test_same_text_in_every_encoding(tmp_path: Path, data: bytes, encoding: str) -> None:
    """Text comes without mark and with the line ends of the file; the encoding is told."""
    path = tmp_path / "log.csv"
    path.write_bytes(data)
    assert read_encoded(path) == (TEXT, encoding)
    assert read_text(path) == TEXT


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"log\.csv: expected text, got an empty file"),
        (b" \r\n\n", r"log\.csv: expected text, got an empty file"),
        (b"a\nb\nc\xff", r"log\.csv:3: expected UTF-8 text, got byte 0xff"),
        (b"a\nb\0", r"log\.csv:2: expected text, got a zero byte"),
        ("a,b".encode("utf-16-le"), r"log\.csv:1: expected text, got .*UTF-16 without"),
        (b"\xff\xfea", r"log\.csv:1: expected UTF-16LE text"),
    ],
)
def test_what_is_no_text_is_refused(tmp_path: Path, data: bytes, message: str) -> None:
    """Empty, binary and undecodable files are refused, with the line."""
    path = tmp_path / "log.csv"
    path.write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_text(path)


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    """No file, a folder, an impossible name, and more than the limit (a sparse file)."""
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as file:
        os.truncate(file.fileno(), MAX_BYTES + 1)
    with pytest.raises(InputError, match="expected at most 1073741824 bytes, got 1073741825"):
        read_text(huge)
    for path in (tmp_path / "none", tmp_path, "a\0b"):
        with pytest.raises(InputError, match="expected a file that can be read"):
            read_text(path)
