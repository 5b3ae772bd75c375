"""Implicit tiling: a quadtree or octree from bits that say which of its tiles are there.

3D Tiles 1.1, section 11: subtrees of a fixed number of levels, tiles of a level in Morton order.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import msgspec
import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...base.errors import InputError, require_between
from .tile_schema import Availability, ImplicitTiling, Subtree

ReadLink: TypeAlias = Callable[[str], bytes]
"""Reads what a URI beside the tileset leads to."""

_MAX_LEVELS = 30  # cells are counted in 32 bits along an axis
_MAGIC = b"subt"


@dataclass(frozen=True, slots=True)
class ImplicitTiles:
    """Tiles of an implicit tree, parents first.

    Attributes
    ----------
    level : (n,) int
    cell : (n, 3) int
        Position among the cells of its level along each axis; z is 0 in a quadtree.
    parent : (n,) int
        Row of the parent, -1 for the root.
    content : (n,) bool
    """

    level: IntArray
    cell: IntArray
    parent: IntArray
    content: BoolArray


def expand(tiling: ImplicitTiling, read: ReadLink, most: int) -> ImplicitTiles:
    """Return the tiles that are there, at most `most`.

    Raises `InputError` if a subtree is missing or damaged, or more tiles are implied than allowed.
    """
    axes = 2 if tiling.subdivision_scheme == "QUADTREE" else 3
    depth = _check(tiling, axes, most)
    parts: list[tuple[IntArray, IntArray, IntArray, BoolArray]] = []
    waiting: deque[tuple[int, IntArray, int]] = deque([(0, np.zeros(3, dtype=np.int64), -1)])
    known: dict[str, tuple[list[BoolArray], list[BoolArray], BoolArray]] = {}
    count = 0
    while waiting:
        level, cell, parent = waiting.popleft()
        link = fill_template(tiling.subtrees.uri, level, cell)
        if link not in known:
            known[link] = _read_subtree(read(link), link, depth, axes)
        tiles, contents, children = known[link]
        rows, below = np.array([parent]), np.zeros(1, dtype=np.int64)
        for step in range(min(depth, tiling.levels - level)):
            there = tiles[step][below]
            below, rows = below[there], rows[there]
            cells = _cells(below, step, axes) + (cell << step)
            parts.append((np.full(len(below), level + step), cells, rows, contents[step][below]))
            first, count = count, count + len(below)
            if count + len(waiting) > most:
                raise InputError(f"implicit tiling: expected at most {most} tiles, got more")
            rows = np.repeat(np.arange(first, count), 1 << axes)
            below = (below[:, None] * (1 << axes) + np.arange(1 << axes)).ravel()
        if level + depth < tiling.levels:
            chosen = children[below]
            cells = _cells(below[chosen], depth, axes) + (cell << depth)
            waiting.extend(
                zip([level + depth] * len(cells), cells, rows[chosen].tolist(), strict=True)
            )
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return ImplicitTiles(*columns)


def _check(tiling: ImplicitTiling, axes: int, most: int) -> int:
    """Return the levels of a subtree after checking that its bits can be held."""
    depth = tiling.subtree_levels
    require_between(tiling.levels, 1, _MAX_LEVELS, "availableLevels")
    if not (1 <= depth <= _MAX_LEVELS and 1 << (axes * (depth - 1)) <= most):
        raise InputError(
            f"subtreeLevels: expected subtrees of at most {most} tiles, got {depth} levels"
        )
    return depth


def _read_subtree(
    data: bytes, link: str, depth: int, axes: int
) -> tuple[list[BoolArray], list[BoolArray], BoolArray]:
    """Return which tiles and contents of each level are there, and which child subtrees."""
    binary = b""
    try:
        if data[:4] == _MAGIC:
            sizes = np.frombuffer(data, "<u8", 2, 8)
            end = 24 + int(sizes[0])
            data, binary = data[24:end], data[end : end + int(sizes[1])]
        subtree = msgspec.json.decode(data, type=Subtree)
    except (msgspec.MsgspecError, UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"subtree {link}: expected one of 3D Tiles 1.1, got {error}") from error
    starts = [((1 << (axes * step)) - 1) // ((1 << axes) - 1) for step in range(depth + 1)]
    given = subtree.content_availability
    several = given if isinstance(given, list) else [given]
    bits = _bits(subtree, subtree.tile_availability, binary, starts[-1], link)
    content = np.zeros(starts[-1], dtype=np.bool_)
    for availability in several:
        content |= _bits(subtree, availability, binary, starts[-1], link)
    ranges = [slice(a, b) for a, b in pairwise(starts)]
    children = _bits(subtree, subtree.child_subtree_availability, binary, 1 << (axes * depth), link)
    return [bits[r] for r in ranges], [content[r] for r in ranges], children


def _bits(
    subtree: Subtree, availability: Availability, binary: bytes, count: int, link: str
) -> BoolArray:
    """Return `count` flags: all alike, or bits from the lowest of each byte up."""
    if availability.constant is not None:
        return np.full(count, bool(availability.constant))
    number = availability.bits
    views = subtree.buffer_views
    if number is None or not 0 <= number < len(views):
        raise InputError(f"subtree {link}: expected a constant or a bit stream, got neither")
    view = views[number]
    inside = 0 <= view.buffer < len(subtree.buffers) and subtree.buffers[view.buffer].uri is None
    packed = binary[view.byte_offset : view.byte_offset + view.byte_length]
    if not inside or view.byte_offset < 0 or len(packed) * 8 < count:
        raise InputError(
            f"subtree {link}: expected {count} bits inside the file, got {len(packed) * 8}"
        )
    flags = np.unpackbits(np.frombuffer(packed, np.uint8), count=count, bitorder="little")
    return flags.astype(np.bool_)


def _cells(morton: IntArray, level: int, axes: int) -> IntArray:
    """Return the cell of each Morton index of a level, (n, 3)."""
    cell = np.zeros((len(morton), 3), dtype=np.int64)
    for bit in range(level):
        for axis in range(axes):
            cell[:, axis] |= ((morton >> (axes * bit + axis)) & 1) << bit
    return cell


def fill_template(template: str, level: int, cell: IntArray) -> str:
    """Return a URI with level and cell in place of ``{level}``, ``{x}``, ``{y}`` and ``{z}``."""
    for name, value in zip(("level", "x", "y", "z"), (level, *cell.tolist()), strict=True):
        template = template.replace(f"{{{name}}}", str(value))
    return template


def subdivide(kind: int, numbers: FloatArray, tiles: ImplicitTiles, *, flat: bool) -> FloatArray:
    """Return the numbers of each tile's volume, (n, 12), from those of the root's (12,).

    Raises `InputError` if the volume is a sphere, which has no parts.
    """
    if kind == 1:
        raise InputError("implicit tiling: expected a box or a region to divide, got a sphere")
    parts = np.exp2(-tiles.level.astype(np.float64))
    split = np.column_stack((parts, parts, np.ones_like(parts) if flat else parts))
    low = tiles.cell * split
    result = np.zeros((len(parts), 12))
    if kind == 0:
        axes = numbers[3:].reshape(3, 3)
        result[:, :3] = numbers[:3] + (2.0 * low + split - 1.0) @ axes
        result[:, 3:] = (split[:, :, None] * axes).reshape(-1, 9)
        return result
    west, south, east, north, bottom, top = numbers[:6]
    corner = np.array((west, south, bottom))
    size = np.array((east, north, top)) - corner
    if size[0] < 0.0:
        size[0] += 2.0 * np.pi
    result[:, [0, 1, 4]] = corner + low * size
    result[:, [2, 3, 5]] = corner + (low + split) * size
    return result
