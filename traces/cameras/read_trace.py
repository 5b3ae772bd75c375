"""Read a camera trace from a file of any known format, named or recognised by its content."""

from dataclasses import replace
from itertools import islice
from pathlib import Path

from ...base.errors import (
    InputError,
    about_users_code,
    is_file,
    require_kind,
)
from ...base.name_registry import Registry
from ...base.reader_guard import guarded
from .camera_trace import CameraTrace
from .formats.columns import read_columns
from .reading.poses import AS_FOUND, Poses, Reading, trace_of_poses
from .reading.units import UNITS_M
from .text_lines import first_data, read_lines
from .trace_format import TraceFormat

FORMATS: Registry[TraceFormat] = Registry(
    "trace format",
    TraceFormat,
    f"{__package__}.formats",
    {
        "csv": "native_csv:FORMAT",
        "parquet": "native_parquet:FORMAT",
        "chan": "engines.nuke_chan:FORMAT",
        "tum": "tum:FORMAT",
        "euroc": "euroc:FORMAT",
        "kitti": "kitti:FORMAT",
        "headset": "headset:FORMAT",
        "airsim": "engines.airsim:FORMAT",
        "unreal-view": "engines.unreal_view:FORMAT",
        "nerfstudio": "reconstruction.nerfstudio:FORMAT",
        "nerf": "reconstruction.nerf:FORMAT",
        "gaussian-splats": "reconstruction.gaussian_splats:FORMAT",
        "colmap": "reconstruction.colmap:FORMAT",
        "colmap-binary": "reconstruction.colmap:BINARY",
        "open3d-log": "reconstruction.open3d:FORMAT",
        "open3d-json": "reconstruction.open3d:JSON",
        "matrices": "reconstruction.matrices:FORMAT",
        "cesium": "engines.cesium:FORMAT",
        "gltf-camera": "engines.gltf_camera:FORMAT",
        "columns": "columns:FORMAT",
    },
)
"""All formats by name, in the order in which a file is shown to them."""

HEAD_LINES = 100
_WHAT = "a camera trace"


def register_format(name: str, known: TraceFormat) -> None:
    """Give a format of your own a name, and show files to it before the others.

    Raises `InputError` if the name is taken, or `known` is no `TraceFormat`.
    """
    FORMATS.register(name, known)


def read_trace(
    spec: str, format_name: str | None = None, reading: Reading = AS_FOUND
) -> CameraTrace:
    """Read the trace that ``PATH`` or ``PATH#SELECTOR`` names.

    Raises `InputError` if the format is not known, the file breaks it, or a format of a user's own
    fails.

    Parameters
    ----------
    spec
        A path; after ``#``, which trace of a file that holds several (headset), or the file with
        the times (KITTI).
    format_name
        A name in `FORMATS`, or ``file.py:NAME`` or ``package.module:NAME`` of a `TraceFormat`; None
        recognises the format by the content.
    reading
        What the user says about axes, units, rate and columns, in place of what the format does.
    """
    path, selector = split_spec(spec)
    if reading.columns:
        with guarded(path, _WHAT):
            return trace_of_poses(read_columns(path, selector, reading), path, reading)
    with guarded(path, _WHAT):
        name = format_of(path) if format_name is None else format_name
    known = FORMATS.find(name)
    with guarded(path, _WHAT), about_users_code(known.read, name, path):
        found = known.read(path, selector)
    if isinstance(found, Poses):
        with guarded(path, _WHAT):
            return trace_of_poses(found, path, reading)
    trace = require_kind(found, CameraTrace, name, path)
    return trace if reading == AS_FOUND else _said_otherwise(trace, name, reading, path)


def _said_otherwise(trace: CameraTrace, name: str, reading: Reading, path: Path) -> CameraTrace:
    """Return a trace of a format that states its axes and clock; only its unit may be another."""
    if (reading.frame, reading.time_unit, reading.rate_hz) != (None, None, None):
        raise InputError(
            f"expected no frame, time unit or rate for {name}, which states them, got some; "
            "leave them out, or read it as a table with --from columns",
            path=path,
        )
    scale = UNITS_M[reading.unit or "m"]
    return replace(trace, position_m=trace.position_m * scale)


def split_spec(spec: str) -> tuple[Path, str | None]:
    """Path and selector of a specification; a file whose own name holds ``#`` comes first."""
    name, mark, selector = spec.rpartition("#")
    if not mark or is_file(Path(spec)):
        return Path(spec), None
    return Path(name), selector


def format_of(path: Path) -> str:
    """Name in `FORMATS` of a file's format, by its content.

    Raises `InputError` if the file cannot be read, no format recognises it, or one of a user fails.
    """
    lines = _head_lines(path)
    for name in FORMATS:
        known = FORMATS.find(name)
        with about_users_code(known.recognises, name, path):
            if known.recognises(lines):
                return name
    shown = (first_data(lines) or "no data")[:60]
    message = (
        f"expected a camera trace of a known format ({', '.join(FORMATS)}), got {shown!r}; "
        "convert it to the native CSV, or name the format"
    )
    raise InputError(message, path=path)


def _head_lines(path: Path) -> list[str]:
    """First non-blank lines of a text file; of a binary one only what it begins with, or is."""
    try:
        with path.open("rb") as file:
            head = file.read(64)
        if head[:4] == b"PAR1":
            return ["PAR1"]
        if head[:4] == b"glTF":
            return ["binary glTF"]
        if b"\0\0\0" in head and path.suffix == ".bin":
            return [f"binary {path.name}"]
    except (OSError, ValueError):
        pass  # reading the text says what is wrong
    stripped = (line.strip() for line in read_lines(path))
    return list(islice(filter(None, stripped), HEAD_LINES))
