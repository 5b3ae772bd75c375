"""Hashes of values by their content: equal values have equal hashes on every machine."""

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

SIZE_BYTES = 16
"""Of a hash; 2**64 values are needed for two to meet by chance."""


def content_hash(*values: object) -> str:
    """Return the hash of plain values, arrays, and dataclasses, sequences and mappings of these.

    Fields of a dataclass that take no part in its comparison, such as caches, do not count.

    Raises TypeError for what has no content to tell it by, such as a function.
    """
    digest = hashlib.blake2b(digest_size=SIZE_BYTES)
    for value in values:
        _add(digest, value)
    return digest.hexdigest()


def hash_bytes(content: bytes) -> str:
    """Return the hash of bytes, such as of a file."""
    return hashlib.blake2b(content, digest_size=SIZE_BYTES).hexdigest()


def _add(digest: Any, given: object) -> None:
    """Add a value, told apart by its kind, with its length first where it has one."""
    value: Any = given  # an untyped edge: what the checks below find it to be
    if isinstance(given, np.ndarray):
        # Bytes in C order and little endian: neither the layout nor the machine is content.
        array = np.ascontiguousarray(value, value.dtype.newbyteorder("<"))
        if array.dtype.hasobject:
            raise TypeError("no content to hash: an array of objects")
        digest.update(f"array {array.dtype.str} {value.shape}\n".encode())
        digest.update(array.tobytes())
    elif isinstance(given, (np.generic, bool, int, float, str, bytes)) or given is None:
        plain: object = value.item() if isinstance(given, np.generic) else value
        text = repr(plain)
        digest.update(f"{type(plain).__name__} {len(text)} {text}\n".encode())
    elif is_dataclass(given) and not isinstance(given, type):
        known = [field for field in fields(value) if field.compare]
        digest.update(f"record {type(value).__qualname__} {len(known)}\n".encode())
        for field in known:
            _add(digest, field.name)
            _add(digest, getattr(value, field.name))
    elif isinstance(given, Mapping):
        digest.update(f"mapping {len(value)}\n".encode())
        for key in sorted(value, key=repr):
            _add(digest, key)
            _add(digest, value[key])
    elif isinstance(given, (tuple, list)):
        digest.update(f"sequence {len(value)}\n".encode())
        for item in value:
            _add(digest, item)
    else:
        raise TypeError(f"no content to hash: {type(value).__name__}")
