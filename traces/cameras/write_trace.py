"""Write a camera trace to a file, whole or not at all."""

from pathlib import Path

from ...base.errors import InputError
from ...base.whole_file import whole_file
from .camera_trace import CameraTrace
from .read_trace import FORMATS
from .trace_format import TraceFormat


def write_trace(trace: CameraTrace, path: Path, format_name: str | None = None) -> TraceFormat:
    """Write a trace and return the format used.

    Raises `InputError` if the format is not known, cannot hold the trace, or the file cannot be
    written; a file that was there before stays as it was.

    Parameters
    ----------
    format_name
        A key of `FORMATS` that can be written; None takes it from the file's suffix.
    """
    chosen = format_for_writing(path, format_name)
    assert chosen.write is not None
    with whole_file(path) as partial:
        chosen.write(trace, partial)
    return chosen


def format_for_writing(path: Path, format_name: str | None = None) -> TraceFormat:
    """Format to write, by name or by the suffix of the path.

    Raises `InputError` if no format that can be written has this name or suffix.
    """
    writable = {name: known for name, known in FORMATS.items() if known.write is not None}
    if format_name is not None:
        if format_name in writable:
            return writable[format_name]
        raise InputError(
            f"expected a format to write out of {', '.join(writable)}, got {format_name!r}; "
            "name one"
        )
    for candidate in writable.values():
        if path.suffix.lower() in candidate.suffixes:
            return candidate
    suffixes = [suffix for known in writable.values() for suffix in known.suffixes]
    raise InputError(
        f"expected a name that ends in {', '.join(suffixes)}, got {path.name!r}; "
        "change the name or name the format",
        path=path,
    )
