"""Write a camera trace to a file, whole or not at all."""

from pathlib import Path

from ...base.errors import InputError
from ...base.files.whole_file import whole_file
from .camera_trace import CameraTrace
from .read_trace import FORMATS


def write_trace(trace: CameraTrace, path: Path, format_name: str | None = None) -> str:
    """Write a trace and return the name of the format used.

    Raises `InputError` if the format is not known, cannot hold the trace, or the file cannot be
    written; a file that was there before stays as it was.

    Parameters
    ----------
    format_name
        As for `read_trace`, of a format that can be written; None takes it from the file's suffix.
    """
    name = format_for_writing(path, format_name)
    write = FORMATS.find(name).write
    assert write is not None
    with whole_file(path) as partial:
        write(trace, partial)
    return name


def format_for_writing(path: Path, format_name: str | None = None) -> str:
    """Name of the format to write: the one that is given, or by the suffix of the path.

    Raises `InputError` if no format that can be written has this name or suffix.
    """
    writable = {name: known for name in FORMATS if (known := FORMATS.find(name)).write is not None}
    if format_name is not None:
        if FORMATS.find(format_name).write is not None:
            return format_name
        raise InputError(
            f"expected a format to write out of {', '.join(writable)}, got {format_name!r}; "
            "name one"
        )
    for name, candidate in writable.items():
        if path.suffix.lower() in candidate.suffixes:
            return name
    suffixes = [suffix for known in writable.values() for suffix in known.suffixes]
    message = (
        f"expected a name that ends in {', '.join(suffixes)}, got {path.name!r}; "
        "change the name or name the format"
    )
    raise InputError(message, path=path)
