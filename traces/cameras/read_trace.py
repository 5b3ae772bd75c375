"""Read a camera trace from a file of any known format, named or recognised by its content."""

from itertools import islice
from pathlib import Path

from ...base.errors import InputError, about_users_code, is_file, require_kind
from ...base.name_registry import Registry
from .camera_trace import CameraTrace
from .text_lines import first_data, read_lines
from .trace_format import TraceFormat

FORMATS: Registry[TraceFormat] = Registry(
    "trace format",
    TraceFormat,
    f"{__package__}.formats",
    {
        "csv": "native_csv:FORMAT",
        "parquet": "native_parquet:FORMAT",
        "tum": "tum:FORMAT",
        "euroc": "euroc:FORMAT",
        "kitti": "kitti:FORMAT",
        "headset": "headset:FORMAT",
    },
)
"""All formats by name, in the order in which a file is shown to them."""

HEAD_LINES = 100


def register_format(name: str, known: TraceFormat) -> None:
    """Give a format of your own a name, and show files to it before the others.

    Raises `InputError` if the name is taken, or `known` is no `TraceFormat`.
    """
    FORMATS.register(name, known)


def read_trace(spec: str, format_name: str | None = None) -> CameraTrace:
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
    """
    path, selector = split_spec(spec)
    name = format_of(path) if format_name is None else format_name
    known = FORMATS.find(name)
    with about_users_code(known.read, name, path):
        trace = known.read(path, selector)
    return require_kind(trace, CameraTrace, name, path)


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
    """First non-blank lines of a text file; of a Parquet file only the mark it begins with."""
    try:
        with path.open("rb") as file:
            if file.read(4) == b"PAR1":
                return ["PAR1"]
    except (OSError, ValueError):
        pass  # reading the text says what is wrong
    stripped = (line.strip() for line in read_lines(path))
    return list(islice(filter(None, stripped), HEAD_LINES))
