"""What a camera-trace format is: how to recognise it, how to read and write it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from .camera_trace import CameraTrace
from .reading.poses import Poses


@dataclass(frozen=True, slots=True)
class TraceFormat:
    """One file format of camera traces.

    Parameters
    ----------
    what
        One line for tables.
    recognises
        Takes the first non-blank lines (of a Parquet file, ``PAR1``; of another binary one,
        ``binary`` and its name) and says whether they are of this format.
    read
        Takes the path and the part of the specification after ``#`` (None when there is none);
        returns a trace, or poses in the file's own axes and units.
    write
        Writes a trace to a path; None where the format is only read.
    suffixes
        File names that `write_trace` takes for this format.
    """

    what: str
    recognises: Callable[[list[str]], bool]
    read: Callable[[Path, str | None], CameraTrace | Poses]
    write: Callable[[CameraTrace, Path], None] | None = None
    suffixes: tuple[str, ...] = ()


def refuse_selector(selector: str | None, path: Path, name: str) -> None:
    """Raise `InputError` if a selector was given to a format that holds one trace a file."""
    if selector is not None:
        message = (
            f"expected no selector, since a {name} file holds one trace, got #{selector}; remove it"
        )
        raise InputError(message, path=path)
