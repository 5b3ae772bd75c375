"""The field of view of a replay: as it is told, or as the paths state it."""

from collections.abc import Sequence

from ...base.errors import InputError
from ...traces.cameras.camera_trace import CameraTrace

USUAL_FOVY_DEG = 60.0
"""Of paths that state none."""


def field_of_view(paths: Sequence[CameraTrace], told_deg: float | None = None) -> float:
    """Return the vertical field of view, degrees, under which paths are replayed.

    What is told comes first, then what the files of the paths state; paths that state nothing go
    along.

    Raises `InputError` if nothing is told and paths state different ones.
    """
    if told_deg is not None:
        return told_deg
    stated = {path.fovy_deg: path.name for path in paths if path.fovy_deg is not None}
    if len(stated) > 1:
        (one, first), (other, second) = list(stated.items())[:2]
        raise InputError(
            f"fovy_deg: expected paths of one field of view, got {one:.4g} degrees in {first} and "
            f"{other:.4g} in {second}; name one for all, as --fovy-deg {one:.4g}"
        )
    return next(iter(stated), USUAL_FOVY_DEG)


def whose_field_of_view(paths: Sequence[CameraTrace], fovy_deg: float) -> str:
    """Return in words how a field of view stands to what paths state; '' where none states one."""
    stated = {path.fovy_deg: path.name for path in paths if path.fovy_deg is not None}
    if fovy_deg in stated:
        return f"as {stated[fovy_deg]} states it"
    others = ", ".join(f"{other:.4g} of {name}" for other, name in stated.items())
    return f"in place of {others}" if others else ""
