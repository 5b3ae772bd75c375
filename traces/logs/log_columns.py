"""Which column of a log is which predictor or time, by the names that tools and people use.

A mapping (``gpu_ms=GPUTime``) goes before the table of aliases, and the first alias in the table
that a log has goes before the later ones.  Units come from the column's name; where the name has
none, milliseconds.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from .render_log import COUNTS, TIMES

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
    "time_s": (
        *("times", "timeinseconds", "elapseds", "elapsed", "timefromfirstframe", "timestamp"),
        *("time", "t"),
    ),
}
for _name in COUNTS:
    ALIASES.setdefault(_name, (_name.replace("_", ""),))


@dataclass(frozen=True, slots=True)
class LogColumn:
    """A column of a log under the name that lodbench gives it.

    `unit` is of times only: "ns", "us", "ms", "s", or "" where the name of the column has none.
    """

    name: str
    index: int
    source: str
    unit: str


def find_columns(
    header: Sequence[str],
    mapping: Mapping[str, str] | None,
    *,
    path: Path,
    line: int | None,
    twins: bool = False,
) -> tuple[tuple[LogColumn, ...], tuple[str, ...]]:
    """Return the columns of a log that are known or mapped, and notes on what was left aside.

    `line` is that of the header; `twins` says that a tool repeats names, so that the first of a
    name is taken.

    Raises `InputError` if the mapping names what does not exist, a column that is needed stands
    twice, or none holds a time.
    """
    _require_known(mapping or {}, header, path, line)
    found: list[LogColumn] = []
    notes: list[str] = []
    keys = [_keys(name) for name in header]
    for name, aliases in ALIASES.items():
        if mapping and name in mapping:
            sources = [mapping[name]]
        else:
            order = [i for alias in aliases for i, forms in enumerate(keys) if alias in forms]
            sources = list(dict.fromkeys(header[i] for i in order))
        if not sources:
            continue
        source = sources[0]
        if header.count(source) > 1 and not twins:
            message = f"expected one column {source}, got {header.count(source)}"
            raise InputError(f"{message}; rename or remove one", path=path, line=line)
        unit = unit_of(source) if name in (*TIMES, "time_s") else ""
        found.append(LogColumn(name, header.index(source), source, unit))
        if len(sources) > 1:
            notes.append(f"{name} is {source}; {', '.join(sources[1:])} left aside")
    found += _of_types(header)
    if not any(column.name in TIMES for column in found):
        shown = ", ".join(header[:40]) + (", …" if len(header) > 40 else "")
        message = f"expected a column with a time ({', '.join(TIMES)}), got {shown}"
        raise InputError(f"{message}; map one, such as gpu_ms=NAME", path=path, line=line)
    return tuple(found), tuple(notes)


def _of_types(header: Sequence[str]) -> list[LogColumn]:
    """Return columns that hold one type's part of a count, such as ``triangles[tree]``."""
    return [
        LogColumn(name, index, name, "")
        for index, name in enumerate(header)
        if name.endswith("]") and name.partition("[")[0] in COUNTS and header.count(name) == 1
    ]


def _require_known(
    mapping: Mapping[str, str], header: Sequence[str], path: Path, line: int | None
) -> None:
    for name, source in mapping.items():
        if name not in ALIASES:
            raise InputError(f"mapping: {unknown_name(name, ALIASES)}")
        if source not in header:
            message = f"mapping of {name}: {unknown_name(source, header)}"
            raise InputError(message, path=path, line=line)


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


def _keys(name: str) -> tuple[str, ...]:
    """Return the forms of a name that aliases are compared with: as it is, and in ms."""
    plain = re.sub(r"[^0-9a-z]", "", name.lower())
    unit = unit_of(name)
    if unit in ("ns", "us"):
        stem = re.sub(r"[\s_(\[.]*(ns|us|µs|μs)[)\]]?$", "", name, flags=re.IGNORECASE)
        return (plain, re.sub(r"[^0-9a-z]", "", stem.lower()) + "ms")
    return (plain, plain.removesuffix("ms")) if plain.endswith("ms") else (plain,)
