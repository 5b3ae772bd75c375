"""Recordings of several paths in a folder: written as each ends, and read again.

A folder for each path holds ``render``, logs of what was drawn and measured, and ``measured``,
the same frames as a frame log; those of the second pass begin with ``again-``.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...base.errors import InputError
from ...base.files.parquet_file import ParquetColumns
from ...sim.frame_log_file import read_frame_log, write_frame_log
from ...traces.logs.formats.log_csv import header_pairs
from ...traces.logs.formats.log_parquet import HEADER_KEY
from ...traces.logs.log_writer import header_text, write_log
from ..study.comparison_folder import frame_log_names
from .recordings import Recorded
from .replays import Recordings

RECORDINGS = "recordings"
"""Name of such a folder in that of a validation."""

_MEASURED, _RENDERED = "measured", "render"
_AGAIN = "again-"


def case_folders(names: Sequence[str]) -> list[str]:
    """Return a folder's name for each path, distinct on every file system."""
    numbered: list[str] = []
    for at, name in enumerate(names):
        own, number = name, at + 1
        # Another case may be called as this one's number would have it.
        while own in numbered or (own != name and own in names):
            own, number = f"{name}-{number}", number + 1
        numbered.append(own)
    found = frame_log_names(numbered)
    return [found[name].removesuffix(".parquet") for name in numbered]


def write_recording(
    folder: Path, labels: Sequence[str], label: str, again: int, item: Recorded
) -> None:
    """Write one recording of one path's folder, which is made if it is not there."""
    name = f"{_AGAIN * again}{frame_log_names(list(labels))[label]}"
    for kind in (_MEASURED, _RENDERED):
        (folder / kind).mkdir(parents=True, exist_ok=True)
    write_frame_log(folder / _MEASURED / name, item.frames)
    write_log(folder / _RENDERED / name, item.columns, item.header)


def forget_recordings(folder: Path, labels: Sequence[str], label: str) -> None:
    """Remove what was written of a policy that failed later: one pass of it is no recording."""
    name = frame_log_names(list(labels))[label]
    for kind in (_MEASURED, _RENDERED):
        for prefix in ("", _AGAIN):
            (folder / kind / f"{prefix}{name}").unlink(missing_ok=True)


def find_recordings(folder: Path) -> Path:
    """Return where the recordings are in a validation's folder, or in one that was left half-done.

    Raises `InputError` if there are none.
    """
    for found in (folder / RECORDINGS, folder):
        if any(found.glob(f"*/{_MEASURED}")):
            return found
    message = "expected recordings that `lodbench validate --out` wrote, got none; name its folder"
    raise InputError(message, path=folder)


def read_recordings(folder: Path, labels: Sequence[str], wanted: Mapping[str, str]) -> Recordings:
    """Return the recordings of one path.

    A policy without one fails by name.  Raises `InputError` if there is none of any, or one is
    broken or was recorded under other conditions.

    Parameters
    ----------
    wanted
        Entries that the headers of the render logs must have, as `recordings.conditions` returns
        them.
    """
    if not folder.is_dir():
        others = ", ".join(sorted(path.name for path in folder.parent.iterdir() if path.is_dir()))
        message = f"expected recordings of {folder.name}, got those of {others}; record again"
        raise InputError(message, path=folder.parent)
    found = Recordings({}, {})
    for label, name in frame_log_names(list(labels)).items():
        names = [name, f"{_AGAIN}{name}"]
        there = [each for each in names if (folder / _MEASURED / each).is_file()]
        if there:
            found.policies[label] = [_read(folder, e, {**wanted, "policy": label}) for e in there]
        else:
            found.failed[label] = "it was not recorded"
    if not found.policies:
        raise InputError(
            f"expected a recording of {labels[0]}, got none; give a folder that `lodbench validate "
            "--out` wrote with that policy",
            path=folder,
        )
    ordered = {label: found.policies[label] for label in labels if label in found.policies}
    return Recordings(ordered, found.failed)


def _read(folder: Path, name: str, wanted: Mapping[str, str]) -> Recorded:
    frames = read_frame_log(folder / _MEASURED / name)
    path = folder / _RENDERED / name
    # Not as a render log of any engine's, which has no reference drawing and no lag.
    table = ParquetColumns(path)
    header = dict(header_pairs([table.text(HEADER_KEY)]))
    for key, value in wanted.items():
        if (got := header.get(key)) != header_text(value):
            message = f"expected a recording with {key} {value}, got {got}; record again"
            raise InputError(message, path=path)
    if len(frames) != len(table):
        message = (
            f"expected the {len(table)} frames of its render log, got {len(frames)}; record again"
        )
        raise InputError(message, path=folder / _MEASURED / name)
    return Recorded(header, {name: table.numbers(name) for name in table.numeric_names}, frames)
