"""Parts: the files of rows that a folder of results is made of.

Results arrive a few at a time, and each file that is made of them must be on the disk before they
count.  Small files are merged as they become many, those of like size with each other, so that a
row is written again at most three times and 100,000 runs make some seventy files.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from ....base.content_hash import hash_bytes
from ....base.errors import InputError
from ....base.files.whole_file import write_whole
from .manifest import PARTS, Part

FAN = 16
"""So many files of one tier become one of the next."""
_LAST_TIER = 3  # of at least 4,096 rows, where a file is large enough for the disk to be busy

FINAL, EARLY = "part", "early"
"""First words of the names of files whose rows stand in the study's order, and of those before."""

NAME = re.compile(rf"(?:{FINAL}|{EARLY})-(\d{{5,}})\.parquet")


def write_part(folder: Path, word: str, number: int, table: pa.Table) -> Part:
    """Write rows to a file and force it to the disk; equal rows make equal bytes.

    Raises `InputError` as `write_whole`.
    """
    content = encode_rows(table)
    name = f"{word}-{number:05d}.parquet"
    write_whole(folder / PARTS / name, content)
    return Part(name, len(table), hash_bytes(content))


def size_of(table: pa.Table) -> int:
    """Return the bytes that a part of these rows would have."""
    return len(encode_rows(table))


def encode_rows(table: pa.Table) -> bytes:
    """Return rows as the bytes of a Parquet file."""
    sink = pa.BufferOutputStream()
    # Only texts: a dictionary of numbers could make one of all NaN.
    texts = [name for name in table.column_names if table.field(name).type == pa.string()]
    options: dict[str, Any] = {"compression": "zstd", "use_dictionary": texts}
    parquet.write_table(table, sink, **options)
    return sink.getvalue().to_pybytes()


def read_part(folder: Path, part: Part, columns: Sequence[str] | None = None) -> pa.Table:
    """Return the rows of a part, or some of their columns.

    Raises `InputError` if it is missing, or not what was written.
    """
    path = folder / PARTS / part.file
    try:
        content = path.read_bytes()
    except OSError as error:
        raise _damaged(path, error.strerror or str(error)) from error
    if hash_bytes(content) != part.hash:
        raise _damaged(path, "other bytes")
    reader: Any = pa.BufferReader(content)
    # Threads save little here, and at the end of the process Arrow's may still run.
    return parquet.read_table(
        reader, columns=None if columns is None else list(columns), use_threads=False
    )


def column_names(folder: Path, part: Part) -> list[str]:
    """Return the columns of a part by name; raises `InputError` if it is missing or damaged."""
    path = folder / PARTS / part.file
    try:
        return list(parquet.read_schema(path).names)
    except (OSError, pa.ArrowException) as error:
        raise _damaged(path, "no columns") from error


def number_of(part: Part) -> int:
    """Return the number in a part's name, -1 if it has none."""
    named = NAME.fullmatch(part.file)
    return -1 if named is None else int(named[1])


def find_mergeable(parts: Sequence[Part]) -> list[Part]:
    """Return parts that are to become one, none if there are few of every size."""
    for tier in range(_LAST_TIER):
        alike = [part for part in parts if _tier(part) == tier]
        if len(alike) >= FAN:
            return alike
    return []


def _tier(part: Part) -> int:
    tier = 0
    while part.rows >= FAN ** (tier + 1) and tier < _LAST_TIER:
        tier += 1
    return tier


def _damaged(path: Path, got: str) -> InputError:
    return InputError(
        f"expected the part that was written, got {got}; run the study again to make it anew",
        path=path,
    )
