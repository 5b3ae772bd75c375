"""The manifest of a folder of results: which files count, and whether that is all.

What it does not list does not exist: a file that was being written when the process ended is swept
by the next start.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import msgspec

from ....base.content_hash import content_hash
from ....base.errors import InputError
from ....base.files.strict_json import encode_record, read_json
from ....base.files.whole_file import write_whole
from .record import SCHEMA

MANIFEST = "manifest.json"
PARTS = "parts"
OURS = (
    r"manifest\.json|run-info\.json|frames(/([0-9a-f]+\.parquet|\.lodbench-.*))?"
    r"|parts(/((early|part)-\d+\.parquet|\.lodbench-.*))?"
)
"""The names in a folder of results, with those of what a killed process was writing."""

_ADVICE = "name a folder of results, or run the study again"


@dataclass(frozen=True, slots=True)
class Part:
    """One file of results.

    Attributes
    ----------
    file : str
        Its name in the folder `PARTS`.
    rows : int
    hash : str
        Of its bytes.
    """

    file: str
    rows: int
    hash: str


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a folder of results holds.

    Attributes
    ----------
    study : str
        Hash of the study (`RunList.digest`).
    runs : int
        Runs of the study, finished or not.
    complete : bool
        Whether every run is finished and the rows stand in the order of the study.
    parts : tuple of Part
    seal : str
        Hash of all the rest, as the file has it: what is damaged may still be JSON.
    """

    study: str
    runs: int
    complete: bool = False
    parts: tuple[Part, ...] = ()
    seal: str = ""
    schema: Literal["lodbench.study/2"] = SCHEMA


def read_manifest(folder: Path) -> Manifest | None:
    """Return the manifest of a folder, None if there is none.

    Raises `InputError` if there is one that cannot be read, such as of a later version.
    """
    path = folder / MANIFEST
    if not path.exists():
        return None
    manifest = read_json(path, Manifest, SCHEMA, _ADVICE)
    if manifest.seal != _seal(manifest) or path.read_bytes() != encode_record(manifest):
        raise InputError(f"expected a whole manifest, got a damaged one; {_ADVICE}", path=path)
    unsafe = [part.file for part in manifest.parts if Path(part.file).name != part.file]
    if unsafe:
        raise InputError(f"expected parts in {PARTS}, got {unsafe[0]}; {_ADVICE}", path=path)
    return manifest


def is_later(folder: Path) -> bool:
    """Whether the manifest of a folder is one of another version: sound, and not ours to judge."""
    try:
        found = msgspec.json.decode((folder / MANIFEST).read_bytes(), type=dict[str, object])
    except (OSError, msgspec.MsgspecError, RecursionError):
        return False
    schema = found.get("schema")
    return isinstance(schema, str) and schema.startswith("lodbench.study/") and schema != SCHEMA


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Put a manifest in place in one step; raises `InputError` as `write_whole`."""
    sealed = replace(manifest, seal=_seal(manifest))
    write_whole(folder / MANIFEST, encode_record(sealed))


def _seal(manifest: Manifest) -> str:
    return content_hash(replace(manifest, seal=""))
