"""Frame logs of a study, a file each beside its parts, named by the digest of its run."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from ....base.content_hash import hash_bytes
from ....base.files.scratch import sweep
from ....sim.frame_log import FrameLog
from ....sim.frame_log_file import read_frame_log, write_frame_log

FRAMES = "frames"


def log_path(folder: Path, digest: str) -> Path:
    """Return the file of the frame log of a run."""
    return folder / FRAMES / f"{digest}.parquet"


def write_log(folder: Path, digest: str, log: FrameLog) -> str:
    """Write a frame log, force it to the disk, and return the hash of its file.

    Raises `InputError` as `write_whole`.
    """
    path = log_path(folder, digest)
    path.parent.mkdir(exist_ok=True)
    write_frame_log(path, log)
    return hash_bytes(path.read_bytes())


def read_log(folder: Path, digest: str) -> FrameLog:
    """Return the frame log of a run; raises `InputError` as `read_frame_log`."""
    return read_frame_log(log_path(folder, digest))


def is_sound(folder: Path, digest: str, log_hash: str) -> bool:
    """Whether the file of a frame log holds what was written."""
    try:
        return hash_bytes(log_path(folder, digest).read_bytes()) == log_hash
    except OSError:
        return False


def sweep_logs(folder: Path, known: set[str]) -> None:
    """Remove the frame logs of all other runs, whose results never became durable."""
    sweep(folder / FRAMES)
    for path in _files(folder):
        if path.stem not in known:
            path.unlink(missing_ok=True)
    with suppress(OSError):  # it holds logs, or is not there
        (folder / FRAMES).rmdir()


def _files(folder: Path) -> Iterator[Path]:
    with suppress(FileNotFoundError, NotADirectoryError):
        yield from list((folder / FRAMES).glob("*.parquet"))
