"""KTX2 textures: what they take on the GPU, from their header.

Khronos, "KTX File Format Specification" version 2.0, sections 3 (header) and 3.10 (descriptor).
"""

from typing import Any

import numpy as np

from ...base.errors import InputError

_MAGIC = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = 80  # bytes before the index of levels
_MOST_SIDE, _MOST_LAYERS = 1 << 16, 1 << 14
_BASIS_LZ, _ETC1S, _UASTC = 1, 163, 166
_MIPS = 4.0 / 3.0  # of a chain over its first level


def is_ktx2(data: bytes) -> bool:
    """Return whether bytes begin as KTX2 does."""
    return data.startswith(_MAGIC)


def ktx2_bytes(data: bytes) -> float:
    """Return the bytes that a texture takes on the GPU, all its levels, layers and faces.

    Levels of a format of the GPU are stored as they are.  Basis Universal becomes blocks of 4 by 4
    texels: 16 bytes of UASTC (BC7, ASTC), 8 of ETC1S (BC1, ETC1), 16 with a second slice (BC3).
    Where the file leaves the mip chain to the loader, it counts.

    Raises `InputError` if the header is damaged.
    """
    if len(data) < _HEADER or not is_ktx2(data):
        raise InputError(f"expected a KTX2 texture, got other or too few bytes ({len(data)})")
    words: list[int] = np.frombuffer(data, "<u4", 11, 12).tolist()
    file_format, _, width, height, depth, layers, faces, levels, scheme, at, length = words
    sides = (width, max(height, 1), max(depth, 1))
    images = max(layers, 1) * faces
    if not (
        0 < width <= _MOST_SIDE and max(sides) <= _MOST_SIDE and levels <= max(sides).bit_length()
    ):
        raise InputError(f"expected sides of 1 to 65536 texels and their levels, got {words[2:5]}")
    if faces not in (1, 6) or images > _MOST_LAYERS:
        raise InputError(f"expected 1 or 6 faces and at most 16384 images, got {faces}, {images}")
    count = max(levels, 1)
    if _HEADER + 24 * count > len(data):
        raise InputError(f"expected an index of {count} levels, got {len(data)} bytes")
    whole = 1.0 if levels else _MIPS
    if file_format:
        index: Any = np.frombuffer(data, "<u8", 3 * count, _HEADER).reshape(-1, 3)
        stored = float(index[:, 2].astype(float).sum())  # before any supercompression
        if stored > 16.0 * _MIPS * float(np.prod(sides, dtype=float)) * images + 16.0 * count:
            raise InputError(f"expected at most 16 bytes a texel, got {stored:g} bytes")
        return whole * stored
    block = _block_bytes(data[at : at + length], scheme)
    blocks = sum(_blocks(sides, level) for level in range(count))
    return whole * block * blocks * images


def _blocks(sides: tuple[int, int, int], level: int) -> int:
    width, height, depth = (max(side >> level, 1) for side in sides)
    return -(-width // 4) * -(-height // 4) * depth


def _block_bytes(descriptor: bytes, scheme: int) -> int:
    """Return the bytes of a block of 4 by 4 texels that Basis Universal becomes."""
    if len(descriptor) < 44:
        raise InputError(f"expected a format descriptor, got {len(descriptor)} bytes")
    model = descriptor[12]
    if model == _UASTC:
        return 16
    if model != _ETC1S or scheme != _BASIS_LZ:
        raise InputError(f"expected Basis Universal (ETC1S, UASTC), got color model {model}")
    samples = (int.from_bytes(descriptor[10:12], "little") - 24) // 16
    return 8 if samples < 2 else 16
