"""The roles that columns of a log can have, each as the words that its names are made of.

One table for all engines and tools.  A name has a role if it holds all words of one of the role's
patterns and none that the role forbids; a unit counts as the word ``time``.  Of several roles the
one whose pattern covers most of the name has it, so that ``skinned_vertices`` are no ``vertices``.
"""

from dataclasses import dataclass

from ..render_log import COUNTS
from .column_words import words_of

Words = frozenset[str]


def _patterns(*texts: str) -> tuple[Words, ...]:
    return tuple(frozenset(text.split()) for text in texts)


@dataclass(frozen=True, slots=True)
class Role:
    """What a column can be.

    Attributes
    ----------
    patterns : sets of words, the best first: busy times go before those that may include waiting
    forbids : words with which a name is of something else
    strict : whether a name may hold no other word but `NOISE`
    timed : whether the values are times
    """

    patterns: tuple[Words, ...]
    forbids: Words = frozenset()
    strict: bool = False
    timed: bool = False


NOISE = frozenset(
    (
        *("total", "count", "counts", "num", "number", "nr", "n", "of", "in", "per", "the", "get"),
        *("render", "rendered", "rendering", "rhi", "info", "stats", "stat", "viewport", "frame"),
        *("measured", "value", "raw", "current", "last", "drawn", "engine", "scene", "submitted"),
        *("renderer", "data", "perf", "profiler", "profile", "counter", "performance", "monitor"),
    )
)
"""Words that change nothing of what a column is."""

PARTS = frozenset(
    (
        *("shadow", "shadows", "post", "pass", "prepass", "ui", "gui", "hud", "base", "basepass"),
        *("depth", "light", "lights", "lighting", "translucency", "transparent", "opaque", "ssao"),
        *("bloom", "fog", "culling", "cull", "physics", "ai", "anim", "animation", "audio"),
        *("script", "update", "particles", "particle", "sky", "water", "terrain", "upload", "copy"),
        *("compute", "submit", "query", "input", "network", "loading", "gc", "shader", "shaders"),
        *("compile", "streaming", "velocity", "reflection", "reflections", "gbuffer", "deferred"),
        *("static", "dynamic", "instanced", "batched", "async", "vr", "editor", "overlay"),
    )
)
"""Words of one pass, system or kind: a part of the frame, never the whole."""

_NEVER = frozenset(
    (
        *("mem", "memory", "mb", "gb", "kb", "mib", "gib", "bytes", "util", "utilization", "usage"),
        *("load", "%", "percent", "pct", "temp", "temperature", "power", "pwr", "watt", "watts"),
        *("fan", "vram", "mhz", "ghz", "clk", "voltage", "max", "min", "avg", "average", "mean"),
        *("median", "budget", "target", "limit", "latency", "wait", "idle", "culled", "saved"),
        *("smoothed", "smooth", "id", "index", "error", "critical", "sd", "std", "sum", "offset"),
        *("predicted", "estimated", "model", "percentile", "cap", "available", "free", "used"),
        *("late", "jitter", "dropped", "missed", "ratio", "fraction", "stall", "overhead"),
    )
)

_DURATION = _NEVER | {"fps", "rate"}
_COUNT = _NEVER | {"time", "fps", "rate", "dt", "delta", "duration", "ms"}

ROLES: dict[str, Role] = {
    "frame_ms": Role(
        _patterns(
            *("frame time", "frame interval", "frame delta", "frame duration", "frame dt"),
            *("between present", "between app start", "cpu total frame time", "present interval"),
            *("delta time", "dt", "delta", "interval time", "interval", "between frames"),
            *("frame to frame time", "frame elapsed"),
        ),
        _DURATION | {"gpu", "thread", "sync", "display", "displayed", "first", "since", "latch"},
        timed=True,
    ),
    "gpu_ms": Role(
        _patterns("gpu busy", "gpu active", "gpu time", "gpu duration", "gpu elapsed", "gpu cost"),
        _DURATION | {"cpu", "thread", "clock", "core", "video", "start", "begin", "end"},
        timed=True,
    ),
    "cpu_ms": Role(
        _patterns(
            *("cpu busy", "cpu active", "cpu time", "cpu duration", "cpu elapsed", "cpu cost"),
            *("main thread time", "game thread time", "render thread time", "rhi thread time"),
            *("main time", "game thread", "render thread", "main thread", "rhi thread"),
        ),
        _DURATION | {"gpu", "clock", "core", "start", "begin", "end"},
        timed=True,
    ),
    "time_s": Role(
        _patterns(
            *("time", "elapsed", "elapsed time", "timestamp", "time stamp", "t", "t time", "clock"),
            *(
                "time from first frame",
                "time since start",
                "since start",
                "wall time",
                "clock time",
            ),
            *("start time", "wall clock", "capture time", "uptime", "timestamp time", "app time"),
        ),
        _DURATION
        | {"gpu", "cpu", "thread", "render", "rendered", "delta", "interval", "duration", "busy"}
        | {"total", "rendering"},
        strict=True,
        timed=True,
    ),
    "fps": Role(_patterns("fps", "framerate", "frame rate"), _NEVER, strict=True),
    "draw_calls": Role(
        _patterns("draws calls", "draws", "calls", "batches"),
        _COUNT
        | {"set", "objects", "meshes", "instances", "triangles", "primitives", "vertices", "size"}
        | {"dispatch", "function", "api", "distance", "radius", "dispatches"},
    ),
    "triangles": Role(
        _patterns("triangles", "primitives"), _COUNT | {"draws", "draw", "meshes", "size"}
    ),
    "vertices": Role(_patterns("vertices"), _COUNT | {"draws", "size"}),
    "shaded_samples": Role(
        _patterns("shaded samples", "samples passed", "samples", "fragments", "ps invocations"),
        _COUNT | {"msaa", "size"},
    ),
    "state_changes": Role(_patterns("state changes", "set pass calls", "set pass"), _COUNT),
}
"""Every role by the name that `render_log` gives it; counts that stand here alone by their name."""

for _name in COUNTS:
    ROLES.setdefault(_name, Role((frozenset(words_of(_name).words),), _COUNT, strict=True))

THREADS = frozenset(("game", "main", "render", "rhi"))
"""Of these the longest is the CPU's time: they work on successive frames side by side."""

_SMELLS_OF_TIME = frozenset(
    ("time", "dt", "delta", "interval", "duration", "fps", "elapsed", "busy", "latency", "wait")
)
_SMELLS_OF_COUNT = frozenset(
    (
        *("triangles", "primitives", "vertices", "draws", "calls", "batches", "fragments"),
        *("samples", "pixels", "instances", "meshes", "splats", "meshlets"),
    )
)


def said_by(name: str) -> Words:
    """Return the words of a name, with ``time`` where it states a unit."""
    parts = words_of(name)
    return frozenset((*parts.words, "time")) if parts.unit else frozenset(parts.words)


def role_of(name: str) -> tuple[str, int, Words] | None:
    """Return role, place of the pattern in it, and words beyond pattern and `NOISE`, or None."""
    if name in ROLES and name != "fps":
        return name, -1, frozenset()  # lodbench's own name goes before all others
    said = said_by(name)
    if not words_of(name).words and said:
        return "frame_ms", len(ROLES["frame_ms"].patterns), frozenset()  # a column "ms"
    best: tuple[int, int, str, Words] | None = None
    for role, known in ROLES.items():
        for place, pattern in enumerate(known.patterns):
            if not pattern <= said or (best is not None and len(pattern) <= best[0]):
                continue
            beyond = said - pattern - ({"time"} if known.timed else set())
            rest = beyond - NOISE - ({"cpu"} if role == "cpu_ms" else set())
            if not beyond & known.forbids and not (rest and known.strict):
                best = (len(pattern), place, role, rest)
    return None if best is None else (best[2], best[1], best[3])


def smell_of(name: str) -> str:
    """Return "time" or "count" where a name smells of one, else ''."""
    said = said_by(name)
    if said & _SMELLS_OF_TIME or set(said) in ({"gpu"}, {"cpu"}):
        return "time"
    return "count" if said & _SMELLS_OF_COUNT else ""
