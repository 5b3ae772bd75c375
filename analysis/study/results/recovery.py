"""What of a folder of results is whole, when a study begins or goes on."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from ....base.errors import InputError
from ....base.files.scratch import flush_names, sweep
from .frame_logs import is_sound, sweep_logs
from .manifest import PARTS, Manifest, Part, is_later, read_manifest, write_manifest
from .parts import EARLY, NAME, number_of, read_part, write_part
from .run_list import RunList


@dataclass(frozen=True, slots=True)
class Recovered:
    """What a folder holds of a study.

    Attributes
    ----------
    manifest : Manifest
    failed : dict of str to bool
        By the digest of each finished run, whether it failed.
    """

    manifest: Manifest
    failed: dict[str, bool]


def recover(folder: Path, runs: RunList, *, replaces: bool) -> Recovered:
    """Make a folder ready for a study, and return what it holds of it.

    Files that the manifest does not list are removed.  A part or a frame log that is damaged is
    left out, and its runs with it; where the manifest is damaged nothing counts.  Each of these is
    told in a line on stderr.

    Raises `InputError` if the folder holds another study, unless `replaces`, or cannot be written.
    """
    (folder / PARTS).mkdir(parents=True, exist_ok=True)
    flush_names(folder.parent)  # or the power could take the whole folder with it
    sweep(folder)
    manifest = _find_manifest(folder, runs, replaces=replaces)
    if manifest is None:
        manifest = Manifest(runs.digest, len(runs))
        write_manifest(folder, manifest)
    kept: list[Part] = []
    failed: dict[str, bool] = {}
    number = next_number(manifest.parts)
    for part in manifest.parts:
        about = _read_sound(folder, part)
        if about is None:
            continue
        sound = [
            _has_log(folder, *row) for row in zip(about["digest"], about["log_hash"], strict=True)
        ]
        if not all(sound):
            _tell(
                f"{folder}: expected {sound.count(False)} more frame logs; their runs are repeated"
            )
            rows = read_part(folder, part).filter(pa.array(sound))
            part, number = write_part(folder, EARLY, number, rows), number + 1  # noqa: PLW2901  # the whole part in place of the one with gaps
        kept.append(part)
        for digest, status, good in zip(about["digest"], about["status"], sound, strict=True):
            if good:
                failed[digest] = status != "ok"
    if tuple(kept) != manifest.parts:
        manifest = replace(manifest, parts=tuple(kept), complete=False)
        write_manifest(folder, manifest)
    sweep_parts(folder, manifest.parts)
    sweep_logs(folder, set(failed))
    return Recovered(manifest, failed)


def next_number(parts: Sequence[Part]) -> int:
    """Return a number that the name of no part has."""
    return 1 + max(map(number_of, parts), default=-1)


def sweep_parts(folder: Path, listed: Sequence[Part]) -> None:
    """Remove files of rows that do not count."""
    sweep(folder / PARTS)
    names = {part.file for part in listed}
    for path in list((folder / PARTS).iterdir()):
        if path.name not in names and NAME.fullmatch(path.name):
            path.unlink(missing_ok=True)


def _find_manifest(folder: Path, runs: RunList, *, replaces: bool) -> Manifest | None:
    """Return the manifest of this study, None if it has none that counts."""
    try:
        manifest = read_manifest(folder)
    except InputError as error:
        if is_later(folder) and not replaces:
            raise
        _tell(f"{error}; this study begins anew")
        return None
    if manifest is None or manifest.study == runs.digest:
        return manifest
    if not replaces:
        raise InputError(
            "expected a new folder or results of the same study, got another study's; name another",
            path=folder,
        )
    return None


def _read_sound(folder: Path, part: Part) -> dict[str, list[Any]] | None:
    """Return what recovery wants to know of the rows of a part, None if it is damaged."""
    try:
        return read_part(folder, part, ("digest", "status", "log_hash")).to_pydict()
    except InputError as error:
        _tell(f"{error}; its {part.rows} runs are repeated")
        return None


def _has_log(folder: Path, digest: str, log_hash: str | None) -> bool:
    return log_hash is None or is_sound(folder, digest, log_hash)


def _tell(line: str) -> None:
    print(line, file=sys.stderr)
