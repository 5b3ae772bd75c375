"""The words of a column's name, whatever way they are joined, and the unit that the name states.

``render_gpu_ms``, ``FrameGPUTime``, ``gputime [us]`` and ``Triangles (M)`` are the same few words
in the habits of different engines.  Words are in lower case, synonyms under one word, and units and
multipliers stand apart.
"""

import re
from dataclasses import dataclass
from functools import cache

_UNITS = {
    **dict.fromkeys(("ns", "nsec", "nanos", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("us", "µs", "μs", "usec", "micros", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("ms", "msec", "msecs", "millis", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
}
"""Every spelling of a unit of time.  A rate, ``fps``, is a word."""

_MULTIPLIERS = {
    **dict.fromkeys(("k", "thousand", "thousands"), 1e3),
    **dict.fromkeys(("m", "mio", "million", "millions"), 1e6),
}

_SYNONYMS = {
    **dict.fromkeys(("tri", "tris", "triangle"), "triangles"),
    **dict.fromkeys(("prim", "prims", "primitive", "polys", "polygons", "polycount"), "primitives"),
    **dict.fromkeys(("vert", "verts", "vertex"), "vertices"),
    **dict.fromkeys(("draw",), "draws"),
    **dict.fromkeys(("call",), "calls"),
    **dict.fromkeys(("batch",), "batches"),
    **dict.fromkeys(("sample",), "samples"),
    **dict.fromkeys(("fragment", "frag", "frags"), "fragments"),
    **dict.fromkeys(("times",), "time"),
    **dict.fromkeys(("presents",), "present"),
    **dict.fromkeys(("timestamps",), "timestamp"),
    **dict.fromkeys(("intervals",), "interval"),
    **dict.fromkeys(("gfx", "graphics"), "gpu"),
}

# Words of which names in one case are made: ``frametime``, ``drawcalls``, ``GPUTIME``.
_JOINED = frozenset(
    (
        *("frame", "time", "gpu", "cpu", "render", "game", "main", "thread", "delta", "draw"),
        *("draws", "calls", "call", "count", "busy", "triangle", "triangles", "tris", "stamp"),
        *("vertex", "vertices", "verts", "prims", "primitives", "rhi", "total", "interval"),
        *("batch", "batches", "ms", "ns", "us", "msec", "usec", "set", "pass", "state", "changes"),
        *("present", "presents", "between", "elapsed", "num", "rendered", "shaded", "samples"),
        *("passed", "duration", "seconds", "in", "app", "start", "active", "measured", "viewport"),
    )
)

_COUNTED = ("tris", "triangles", "prims", "primitives", "verts", "vertices", "polys")

_PIECES = re.compile(r"[µμ][sS]|[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+|%")
_BRACKETED = re.compile(r"[\[(]\s*([^\])]{1,24}?)\s*[\])]")


@dataclass(frozen=True, slots=True)
class ColumnWords:
    """A name taken apart.

    Attributes
    ----------
    words : in lower case, synonyms under one word, in the order of the name
    unit : ns, us, ms, s, or '' where the name states none
    multiplier : what a value is to be multiplied by, as 1e6 of ``Triangles (M)``
    """

    words: tuple[str, ...]
    unit: str
    multiplier: float


@cache
def words_of(name: str) -> ColumnWords:
    """Take a column's name apart: camelCase, snake_case, dots, spaces, and units in brackets."""
    unit, multiplier = "", 1.0
    plain = name
    for match in _BRACKETED.finditer(name):
        inner = match[1].lower()
        if inner in _UNITS or inner in _MULTIPLIERS:
            unit = _UNITS.get(inner, unit)
            multiplier = _MULTIPLIERS.get(inner, multiplier)
            plain = plain.replace(match[0], " ")
    pieces = [piece.lower() for part in _PIECES.findall(plain) for piece in _split(part)]
    if not unit:
        unit, pieces = _unit_of(pieces)
    if multiplier == 1.0 and len(pieces) > 1:
        for place in (0, -1):  # kTris, MTriangles, tris_k, triangles_millions
            if pieces[place] in _MULTIPLIERS:
                multiplier = _MULTIPLIERS[pieces.pop(place)]
                break
    return ColumnWords(tuple(_SYNONYMS.get(piece, piece) for piece in pieces), unit, multiplier)


def _unit_of(pieces: list[str]) -> tuple[str, list[str]]:
    """Return the unit at the end of a name, or PresentMon's Ms before it, and the other words.

    A letter alone is a unit only as a word of its own behind another.
    """
    if len(pieces) > 1 and pieces[-1] in _UNITS:
        rest = pieces[:-1]
        return _UNITS[pieces[-1]], rest[:-1] if rest[-1] == "in" and len(rest) > 1 else rest
    if len(pieces) > 1 and pieces[0] in ("ms", "us", "ns"):
        return pieces[0], pieces[1:]
    if len(pieces) == 1 and pieces[0] in _UNITS and len(pieces[0]) > 1:
        return _UNITS[pieces[0]], []
    return "", pieces


def _split(piece: str) -> list[str]:
    """Split a piece in one case into words of `_JOINED`, if it is made of nothing else."""
    text = piece.lower()
    if text in _UNITS or text in _SYNONYMS or text in _JOINED:
        return [text]
    if text[:1] in ("k", "m") and text[1:] in _COUNTED:  # ktris
        return [text[0], text[1:]]
    ways: list[list[str] | None] = [[], *[None] * len(text)]
    for end in range(1, len(text) + 1):
        for start in range(end - 1, -1, -1):
            before = ways[start]
            if before is not None and text[start:end] in _JOINED:
                way = [*before, text[start:end]]
                best = ways[end]
                ways[end] = way if best is None or len(way) < len(best) else best
    return ways[-1] or [text]
