"""Arrays as a page carries them: one compressed text, and where in it each array lies."""

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ALIGN = 8
_KINDS = {"f4": "Float32Array", "i2": "Int16Array", "i4": "Int32Array", "u1": "Uint8Array",
          "u2": "Uint16Array", "u4": "Uint32Array"}  # fmt: skip


def pack_arrays(
    arrays: Mapping[str, NDArray[Any]],
) -> tuple[str, dict[str, tuple[str, int, int]]]:
    """Return base64 of the deflated bytes, and of each array its JavaScript type, place and length.

    Equal arrays give equal texts.

    Raises KeyError if a page has no array of a dtype.
    """
    parts: list[bytes] = []
    places: dict[str, tuple[str, int, int]] = {}
    size = 0
    for name, array in arrays.items():
        data = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).tobytes()
        places[name] = (_KINDS[array.dtype.str[1:]], size, array.size)
        pad = bytes(-len(data) % _ALIGN)
        parts += [data, pad]
        size += len(data) + len(pad)
    return base64.b64encode(zlib.compress(b"".join(parts), 6)).decode(), places
