"""Which column of a log is which predictor or time, by the names that tools and people use.

A mapping (``gpu_ms=GPUTime``) goes before the table of aliases, and the first alias in the table
that a log has goes before the later ones.  Units come from the column's name; where the name has
none, milliseconds.
"""

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ..errors import InputError
from .logtable import LogTable
from .renderlog import CPU_COUNTS, GPU_COUNTS, TIMES

__all__ = ["ALIASES", "Column", "find_columns", "unit_of"]

MS_PER = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}

# Letters and digits only, in lower case; best first.  Busy times go before times that may include
# waiting, calls before batches of calls.
ALIASES: dict[str, tuple[str, ...]] = {
    "draw_calls": (
        *("drawcalls", "drawcallscount", "rhidrawcalls", "draws", "calls", "inforendercalls"),
        *("rendertotaldrawcallsinframe", "batches", "batchescount", "totalbatchescount"),
    ),
    "triangles": (
        *("triangles", "trianglescount", "trianglecount", "tris", "inforendertriangles"),
        *("primitives", "prims", "rhiprimitivesdrawn", "rendertotalprimitivesinframe"),
    ),
    "vertices": ("vertices", "verticescount", "vertexcount", "verts"),
    "shaded_samples": ("shadedsamples", "samplespassed", "samples", "fragments", "psinvocations"),
    "framebuffer_pixels": ("framebufferpixels",),
    "state_changes": ("statechanges", "setpasscallscount", "setpasscalls"),
    "frame_ms": (
        *("framems", "frametime", "frametimems", "cputotalframetime", "msbetweenpresents"),
        *("msbetweenappstart", "deltatime", "deltams", "dt"),
    ),
    "gpu_ms": (
        *("gpums", "gpubusy", "msgpubusy", "msgpuactive", "gputime", "gputimems", "msgputime"),
        *("gpuframetime", "viewportgetmeasuredrendertimegpu"),
    ),
    "cpu_ms": (
        *("cpums", "cpubusy", "mscpubusy", "cputime", "cputimems", "cpumainthreadframetime"),
        *("viewportgetmeasuredrendertimecpu",),
    ),
    "time_s": ("times", "timeinseconds", "elapseds", "elapsed", "timestamp", "time", "t"),
}
for _name in (*GPU_COUNTS, *CPU_COUNTS):
    ALIASES.setdefault(_name, (_name.replace("_", ""),))


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a log under the name that lodbench gives it.

    `unit` is of times only: "ns", "us", "ms", "s", or "" where the name of the column has none.
    """

    name: str
    index: int
    source: str
    unit: str


def find_columns(
    table: LogTable, mapping: Mapping[str, str] | None = None
) -> tuple[tuple[Column, ...], tuple[str, ...]]:
    """Return the columns of a log that are known or mapped, and notes on what was left aside.

    Raises
    ------
    InputError
        If the mapping names what does not exist, or a column that is needed stands twice.
    """
    _require_known(mapping or {}, table)
    found: list[Column] = []
    notes: list[str] = []
    keys = [_key(name) for name in table.header]
    for name, aliases in ALIASES.items():
        if mapping and name in mapping:
            sources = [mapping[name]]
        else:
            order = [i for alias in aliases for i, forms in enumerate(keys) if alias in forms]
            sources = list(dict.fromkeys(table.header[i] for i in order))
        if not sources:
            continue
        if table.header.count(sources[0]) > 1:
            message = f"expected one column {sources[0]}, got {table.header.count(sources[0])}"
            line = table.first_line - 1
            raise InputError(f"{message}; rename or remove one", path=table.path, line=line)
        index = table.header.index(sources[0])
        unit = unit_of(sources[0]) if name in (*TIMES, "time_s") else ""
        found.append(Column(name, index, sources[0], unit))
        if len(sources) > 1:
            notes.append(f"{name} is {sources[0]}; {', '.join(sources[1:])} left aside")
    return tuple(found), tuple(notes)


def _require_known(mapping: Mapping[str, str], table: LogTable) -> None:
    for name, source in mapping.items():
        if name not in ALIASES:
            raise InputError(f"mapping: expected {_listed(ALIASES, name)}, got {name}")
        if source not in table.header:
            raise InputError(
                f"mapping of {name}: expected a column of the log, got {source}; "
                f"{_listed(table.header, source)}",
                path=table.path,
                line=table.first_line - 1,
            )


def _listed(names: Iterable[str], wrong: str) -> str:
    names = list(names)
    near = difflib.get_close_matches(wrong, names, n=1)
    shown = ", ".join(names[:40]) + (", …" if len(names) > 40 else "")
    return f"one of {shown}" + (f" (did you mean {near[0]}?)" if near else "")


def unit_of(name: str) -> str:
    """Return the unit that a column's name ends or begins with: ns, us, ms, s, or ''.

    Recognised are ``gpu_ms``, ``Frame Time (ms)``, ``gpuTimeNs``, ``MsGPUBusy`` and
    ``TimeInSeconds``.
    """
    match = (
        re.search(r"(?:[_\s(\[.])(ns|us|µs|μs|ms|s|sec|seconds)[)\]]?$", name, re.IGNORECASE)
        or re.search(r"(?<=[a-z])(Ns|Us|Ms|InSeconds|InMs)$", name)
        or re.match(r"(Ms|ms)(?=[A-Z])", name)
    )
    if match is None:
        return ""
    unit = match[1].lower().replace("µ", "u").replace("μ", "u").removeprefix("in")
    return "s" if unit in ("sec", "seconds") else unit


def _key(name: str) -> tuple[str, ...]:
    """Return the forms of a name that aliases are compared with: as it is, and in ms."""
    plain = re.sub(r"[^0-9a-z]", "", name.lower())
    unit = unit_of(name)
    if unit in ("ns", "us"):
        stem = re.sub(r"[\s_(\[.]*(ns|us|µs|μs)[)\]]?$", "", name, flags=re.IGNORECASE)
        return (plain, re.sub(r"[^0-9a-z]", "", stem.lower()) + "ms")
    return (plain, plain.removesuffix("ms")) if plain.endswith("ms") else (plain,)
