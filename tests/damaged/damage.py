"""Damage of files as disks, downloads, editors, scripts and people do it; by seed, always the same.

Bytes of any file are flipped, cut, moved and overwritten by odd numbers.  Where a format is known,
its text, JSON, tables or arrays are damaged too and packed again with right lengths and checksums,
so that it is the reader that meets the damage, and not the checksum.
"""

import io
import json
import random
import re
import struct
import zipfile
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pyarrow as pa
from pyarrow import parquet

ODD_NUMBERS = (
    *("nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "-1", "0", "1e400"),
    *("2147483648", "9223372036854775808", "-9223372036854775809"),
    *("0x10", "1,5", "1_000", "٣", "½", "null", "true"),
)
ODD_TEXTS = (
    "",
    " ",
    "\x1b[2J\x07",
    "é" * 40,
    "a" * 5_000,
    "\u202e\u200b",
    "../../x",
    '"',
    "#",
    "%s",
)
ODD_VALUES: tuple[Any, ...] = (
    *(float("nan"), float("inf"), 1e308, -1, 0, 0.5, 2**31, 2**53, 2**63, -(2**63), 10**400),
    *("", "x", "\x1b[2J", "1", "data:,", "a" * 2_000),
    *(None, True, [], {}, [[]], [1, 2, 3], {"uri": "x"}),
)
ODD_BYTES = (
    *(struct.pack("<i", value) for value in (0, -1, 2**31 - 1, -(2**31))),
    *(struct.pack("<q", value) for value in (-1, 2**62, 2**63 - 1)),
    *(struct.pack("<f", value) for value in (float("nan"), float("inf"), 3e38)),
    *(struct.pack("<d", value) for value in (float("nan"), float("-inf"), 1e308)),
    *(
        b"\0" * 16,
        b"\xff" * 16,
        b"\r\n",
        b"\x1b[2J",
        "\ufeff".encode(),
        b"PAR1",
        b"glTF",
        b"PK\3\4",
    ),
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def damage(data: bytes, kind: str, rng: random.Random) -> bytes:
    """Return a file with one to three injuries.

    Parameters
    ----------
    kind
        One of `KINDS`: how the content is known; a third of all files is damaged as mere bytes.
    """
    injure = KINDS[kind] if rng.random() < 0.67 else damage_bytes
    for _ in range(rng.choice((1, 1, 2, 3))):
        data = injure(data, rng)
    return data


def damage_bytes(data: bytes, rng: random.Random) -> bytes:
    """Flip bits, cut, move, repeat, drop, or overwrite."""
    size = max(len(data), 1)
    start = rng.randrange(size)
    end = min(size, start + rng.choice((1, 2, 4, 16, 64, 1_000)))
    odd = rng.choice(ODD_BYTES)
    other = rng.randrange(size)
    flipped = bytearray(data)
    for _ in range(rng.choice((1, 2, 8, 64)) if data else 0):
        flipped[rng.randrange(size)] ^= 1 << rng.randrange(8)
    return rng.choice(
        (
            bytes(flipped),
            bytes(flipped),
            data[:start],
            data[:start] + data[end:],
            data[:end] + data[start:end] * rng.choice((1, 3)) + data[end:],
            data[:start] + odd + data[start + len(odd) :],
            data[: start // 4 * 4] + odd + data[start // 4 * 4 + len(odd) :],
            data[:start] + odd + data[start:],
            data[:other] + data[start:end] + data[other:],
            data[start:] + data[:start],
        )
    )


def damage_text(data: bytes, rng: random.Random) -> bytes:
    """Change numbers, lines and columns of a text."""
    text = data.decode("utf-8", "replace")
    return rng.choice((_other_number, _other_number, _other_lines, _other_columns))(
        text, rng
    ).encode("utf-8", "replace")


def _other_number(text: str, rng: random.Random) -> str:
    """Put an odd number in place of one, or of all in a line or that stand below one another."""
    found = list(_NUMBER.finditer(text))
    if not found:
        return text + rng.choice(ODD_NUMBERS)
    one = rng.choice(found)
    new = rng.choice((*ODD_NUMBERS, *ODD_TEXTS))
    return text[: one.start()] + new + text[one.end() :]


def _other_lines(text: str, rng: random.Random) -> str:
    lines = text.split("\n")
    # The first lines of a file say what it is.
    a, b = rng.randrange(min(len(lines), rng.choice((3, 10**9)))), rng.randrange(len(lines))
    change = rng.randrange(6)
    if change == 0:
        del lines[a]
    elif change == 1:
        lines.insert(b, lines[a])
    elif change == 2:
        lines[a], lines[b] = lines[b], lines[a]
    elif change == 3:
        lines[a] = rng.choice(ODD_TEXTS)
    elif change == 4:
        lines[a] = lines[a] * 2
    else:
        lines[a] = lines[a][: rng.randrange(len(lines[a]) + 1)]
    return rng.choice(("\n", "\n", "\n", "\r\n", "\r")).join(lines)


def _other_columns(text: str, rng: random.Random) -> str:
    """Swap, drop, repeat or overwrite columns in all lines, or change the separator."""
    lines = text.split("\n")
    mark = max(",;\t ", key=text.count)
    if rng.random() < 0.15:
        return text.replace(mark, rng.choice(",;\t |"))
    rows = [line.split(mark) for line in lines]
    width = max(map(len, rows))
    a, b, change = rng.randrange(width), rng.randrange(width), rng.randrange(4)
    odd = rng.choice((*ODD_NUMBERS, *ODD_TEXTS))
    for number, row in enumerate(rows):
        if max(a, b) >= len(row):
            continue
        if change == 0:
            row[a], row[b] = row[b], row[a]
        elif change == 1:
            del row[a]
        elif change == 2:
            row.insert(b, row[a])
        elif number:
            row[a] = odd
    return "\n".join(map(mark.join, rows))


def damage_json(data: bytes, rng: random.Random) -> bytes:
    """Change a value, an item or a key somewhere in a document."""
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError):
        return damage_bytes(data, rng)
    places: list[tuple[Any, Any]] = []
    stack: list[Any] = [tree]
    while stack:
        node = stack.pop()
        keys: list[Any] = list(cast("Any", node) if isinstance(node, dict) else range(len(node)))
        places += [(node, key) for key in keys]
        stack += [node[key] for key in keys if isinstance(node[key], (dict, list))]
    if not places:
        return damage_bytes(data, rng)
    # Outer values are fewer and matter more than the thousands of numbers in a list.
    node, key = rng.choice(places[: rng.choice((20, 200, 10**9))])
    change = rng.randrange(6)
    if change == 0:
        del node[key]
    elif change == 1:
        other, at = rng.choice(places)
        if not isinstance(node[key], (dict, list)) and not isinstance(other[at], (dict, list)):
            node[key], other[at] = other[at], node[key]
    elif change == 2 and isinstance(node, list):
        node.extend([node[key]] * rng.choice((1, 50)))
    elif change == 3:
        node[key] = rng.choice(([node[key]], {"x": node[key]}, str(node[key])[:100]))
    else:
        node[key] = rng.choice(ODD_VALUES)
    text = json.dumps(tree)
    if rng.random() < 0.05:  # a key twice, which no tree can have
        text = text.replace("{", '{"version": 1, "version": "x", ', 1)
    if rng.random() < 0.03:
        text = text.replace(rng.choice(("{}", "[]", "0")), "[" * 3_000, 1)
    return text.encode()


def damage_glb(data: bytes, rng: random.Random) -> bytes:
    """Damage the JSON or the numbers of a binary glTF, and make its lengths right."""
    if len(data) < 28 or data[:4] != b"glTF":
        return damage_bytes(data, rng)
    size = int.from_bytes(data[12:16], "little")
    text, binary = data[20 : 20 + size], data[28 + size :]
    if rng.random() < 0.75:
        text = damage_json(text, rng)
    else:
        binary = damage_bytes(binary, rng)
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def damage_tile(data: bytes, rng: random.Random) -> bytes:
    """Damage the header of a tile's content or subtree, where its lengths stand."""
    at = 4 * rng.randrange(min(len(data) // 4, 10) or 1)
    return data[:at] + rng.choice(ODD_BYTES)[:4] + data[at + 4 :]


def damage_archive(data: bytes, rng: random.Random) -> bytes:
    """Damage a member of a zip of arrays: its JSON, or values, type, shape; or drop or pack it."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename: archive.read(info) for info in archive.infolist()}
    except (zipfile.BadZipFile, ValueError, EOFError, NotImplementedError, RuntimeError):
        return damage_bytes(data, rng)
    if not members:
        return damage_bytes(data, rng)
    name = rng.choice(sorted(members))
    if not name.endswith(".npy"):
        members[name] = damage_json(members[name], rng)
    elif rng.random() < 0.1:
        del members[name]
    else:
        members[name] = _damage_array(members[name], rng)
    packed = io.BytesIO()
    method = zipfile.ZIP_DEFLATED if rng.random() < 0.05 else zipfile.ZIP_STORED
    with zipfile.ZipFile(packed, "w", method) as archive:
        for member, content in members.items():
            archive.writestr(member, content)
    return packed.getvalue()


def _damage_array(data: bytes, rng: random.Random) -> bytes:
    try:
        array = np.load(io.BytesIO(data)).copy()
    except Exception:  # noqa: BLE001 - an earlier injury, of which numpy makes many kinds
        return damage_bytes(data, rng)
    change = rng.randrange(6)
    if change == 0 and array.size and array.dtype.kind in "fiu":
        number = rng.choice((-1, 0, 1, 2**31 - 1, 2**62, 1e308, float("nan"), float("inf")))
        with np.errstate(all="ignore"):
            if array.dtype.kind != "f":
                number = int(np.clip(np.nan_to_num(number), -1, 2**31 - 1))
            array.flat[rng.randrange(array.size)] = number
    elif change == 1:
        array = array[: rng.randrange(len(array) + 1)] if array.ndim else array.reshape(1)
    elif change == 2:
        array = np.concatenate((array, array)) if array.ndim else array
    elif change == 3 and array.dtype.kind in "fiub":
        array = array.astype(rng.choice(("f4", "f8", "i4", "i8", "u1", "?")), casting="unsafe")
    elif change == 4:
        array = array.ravel() if rng.random() < 0.5 else array[..., None]
    else:
        return damage_bytes(data, rng)
    packed = io.BytesIO()
    np.save(packed, array)
    return packed.getvalue()


def damage_parquet(data: bytes, rng: random.Random) -> bytes:
    """Damage values, types, names, columns or the metadata of a Parquet table."""
    try:
        table: Any = parquet.read_table(pa.BufferReader(data))
    except (pa.ArrowException, OSError):
        return damage_bytes(data, rng)
    at = rng.randrange(table.num_columns) if table.num_columns else 0
    change = rng.randrange(7)
    if table.num_columns == 0 or change == 6:
        texts: dict[bytes, bytes] = table.schema.metadata or {}
        metadata = {key: damage_text(text, rng) for key, text in texts.items()}
        table = table.replace_schema_metadata(metadata)
    elif change == 0:
        table = table.remove_column(at)
    elif change == 1:
        table = table.append_column(rng.choice((table.column_names[at], "x\x1b[2J", "")), table[at])
    elif change == 2:
        table = table.slice(0, rng.randrange(table.num_rows + 1))
    elif change == 3:
        table = table.select(rng.sample(table.column_names, table.num_columns))
    else:
        values: list[Any] = table[at].to_pylist()
        odd = rng.choice((float("nan"), float("inf"), 1e308, -1.0, 0.0, 9e15, None))
        for row in [rng.randrange(len(values))] if change == 4 and values else range(len(values)):
            values[row] = odd
        try:
            column: Any = pa.array(values)
        except (pa.ArrowException, OverflowError):
            column = pa.array([str(value) for value in values])
        table = table.set_column(at, table.column_names[at], column)
    packed = io.BytesIO()
    parquet.write_table(table, packed)
    return packed.getvalue()


KINDS: dict[str, Callable[[bytes, random.Random], bytes]] = {
    "bytes": damage_bytes,
    "text": damage_text,
    "json": damage_json,
    "glb": damage_glb,
    "tile": damage_tile,
    "archive": damage_archive,
    "parquet": damage_parquet,
}
