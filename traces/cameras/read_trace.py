"""Read a camera trace from a file of any known format, named or recognised by its content."""

from itertools import islice
from pathlib import Path

from ...base.errors import InputError
from .camera_trace import CameraTrace
from .formats import euroc, headset, kitti, native_csv, native_parquet, tum
from .text_lines import read_lines
from .trace_format import TraceFormat

FORMATS: dict[str, TraceFormat] = {
    module.FORMAT.name: module.FORMAT
    for module in (native_csv, native_parquet, tum, euroc, kitti, headset)
}

HEAD_LINES = 100


def read_trace(spec: str, format_name: str | None = None) -> CameraTrace:
    """Read the trace that ``PATH`` or ``PATH#SELECTOR`` names.

    Raises `InputError` if the format is not known or the file breaks it.

    Parameters
    ----------
    spec
        A path; after ``#``, which trace of a file that holds several (headset), or the file with
        the times (KITTI).
    format_name
        A key of `FORMATS`; None recognises the format by the content.
    """
    path, selector = split_spec(spec)
    chosen = format_of(path) if format_name is None else _named(format_name)
    return chosen.read(path, selector)


def split_spec(spec: str) -> tuple[Path, str | None]:
    """Path and selector of a specification; a file whose own name holds ``#`` comes first."""
    name, mark, selector = spec.rpartition("#")
    if not mark or Path(spec).is_file():
        return Path(spec), None
    return Path(name), selector


def format_of(path: Path) -> TraceFormat:
    """Format of a file, by its content.

    Raises `InputError` if the file cannot be read or no format recognises it.
    """
    lines = _head_lines(path)
    for candidate in FORMATS.values():
        if candidate.recognises(lines):
            return candidate
    shown = next((line for line in lines if not line.startswith("#")), "no data")[:60]
    raise InputError(
        f"expected a camera trace of a known format ({', '.join(FORMATS)}), got {shown!r}; "
        "convert it to the native CSV, or name the format",
        path=path,
    )


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


def _named(name: str) -> TraceFormat:
    if name not in FORMATS:
        raise InputError(f"expected a format out of {', '.join(FORMATS)}, got {name!r}; name one")
    return FORMATS[name]
