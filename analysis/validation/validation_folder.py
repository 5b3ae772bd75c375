"""The folder of a validation: what was recorded, what was simulated, and how they agree."""

import shutil
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ...base.errors import InputError
from ...base.files.strict_json import encode_record
from ...base.files.whole_folder import claimed_folder, require_replaceable, whole_folder
from ...sim.frame_log_file import read_frame_log, write_frame_log
from ...traces.logs.log_writer import header_text, write_log
from ...traces.logs.read_log import read_render_log
from ..study.comparison_folder import frame_log_names
from .recordings import Recorded
from .validate import Pair
from .validation_page import render_validation
from .validation_result import Validation

_RESULT, _REPORT = "validation.json", "report.html"
_MEASURED, _RENDERED, _SIMULATED = "measured", "render", "simulated"
_OURS = r"validation\.json|report\.html|(measured|render|simulated)(/.*)?"
_AGAIN = "again-"


@contextmanager
def claimed_validation(folder: Path | None) -> Generator[None]:
    """Hold a folder, if one is given, from before the work until `write_validation` has written.

    Raises `InputError` unless the folder is new, or holds nothing but an earlier validation, or if
    another process writes to it.
    """
    if folder is None:
        yield
        return
    with claimed_folder(folder, _ours(folder), "validate"):
        yield


def _ours(folder: Path) -> str:
    # Without a result the folders may be somebody's: their names are common words.
    return _OURS if (folder / _RESULT).exists() else ""


def write_validation(
    folder: Path,
    validation: Validation,
    pairs: Mapping[str, Pair],
    recorded: Mapping[str, list[Recorded]] | Path,
) -> None:
    """Write a folder whole: recordings as render and frame logs, simulated replays, and the page.

    Parameters
    ----------
    recorded
        By label, or the folder of an earlier validation, whose recordings are copied.

    Raises
    ------
    InputError
        As `claimed_validation`.
    """
    require_replaceable(folder, _ours(folder), "validate")
    with whole_folder(folder) as partial:
        (partial / _SIMULATED).mkdir()
        names = frame_log_names(list(pairs))
        for label, name in names.items():
            write_frame_log(partial / _SIMULATED / name, pairs[label].simulated)
        if isinstance(recorded, Path):
            for name in (_MEASURED, _RENDERED):
                shutil.copytree(recorded / name, partial / name)
        else:
            _write_recordings(partial, recorded, names)
        (partial / _RESULT).write_bytes(encode_record(validation))
        (partial / _REPORT).write_text(render_validation(validation, pairs), encoding="utf-8")


def _write_recordings(
    folder: Path, recorded: Mapping[str, list[Recorded]], names: Mapping[str, str]
) -> None:
    for kind in (_MEASURED, _RENDERED):
        (folder / kind).mkdir()
    for label, name in names.items():
        for prefix, item in zip(("", _AGAIN), recorded[label], strict=False):
            write_frame_log(folder / _MEASURED / f"{prefix}{name}", item.frames)
            write_log(folder / _RENDERED / f"{prefix}{name}", item.columns, item.header)


def read_recordings(
    folder: Path, labels: list[str], wanted: Mapping[str, str]
) -> dict[str, list[Recorded]]:
    """Return the recordings of policies that `write_validation` wrote, by label.

    Raises `InputError` if one is missing, broken, or was recorded under other conditions.

    Parameters
    ----------
    wanted
        Entries that the headers of the render logs must have, as `recordings.conditions` returns
        them.
    """
    recordings: dict[str, list[Recorded]] = {}
    for label, name in frame_log_names(labels).items():
        if not (folder / _MEASURED / name).is_file():
            raise InputError(
                f"expected a recording of {label}, got none; give a folder that `lodbench validate "
                "--out` wrote with that policy",
                path=folder,
            )
        wanted = {**wanted, "policy": label}
        recordings[label] = [_read(folder, name, wanted)]
        if (folder / _MEASURED / f"{_AGAIN}{name}").is_file():
            recordings[label].append(_read(folder, f"{_AGAIN}{name}", wanted))
    return recordings


def _read(folder: Path, name: str, wanted: Mapping[str, str]) -> Recorded:
    frames = read_frame_log(folder / _MEASURED / name)
    path = folder / _RENDERED / name
    log = read_render_log(path, {"shaded_samples": "projected_px"})
    header = dict(log.header)
    for key, value in wanted.items():
        if (got := header.get(key)) != header_text(value):
            message = f"expected a recording with {key} {value}, got {got}; record again"
            raise InputError(message, path=path)
    if len(frames) != len(log):
        message = (
            f"expected the {len(log)} frames of its render log, got {len(frames)}; record again"
        )
        raise InputError(message, path=folder / _MEASURED / name)
    counts = dict(zip(log.predictors, log.counts.T, strict=True))
    counts["projected_px"] = np.asarray(counts["shaded_samples"])
    return Recorded(header, counts, frames)
