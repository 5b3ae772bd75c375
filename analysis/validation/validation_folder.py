"""The folder of a validation: what was recorded, what was simulated, and how they agree.

It is put in place whole, at the end.  Recordings stand beside it until then, in a folder called as
it and ``.recordings``: they take long, and what comes after them may fail.
"""

import shutil
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from ...base.errors import InputError
from ...base.files.strict_json import encode_record
from ...base.files.whole_folder import claimed_folder, require_replaceable, whole_folder
from ...sim.frame_log_file import write_frame_log
from ..study.comparison_folder import frame_log_names
from .recording_folder import RECORDINGS
from .shown.charts import Series
from .shown.page import render_validation
from .validation_result import Validation

_RESULT, _REPORT, _SIMULATED = "validation.json", "report.html", "simulated"
_OURS = rf"validation\.json|report\.html|({RECORDINGS}|{_SIMULATED})(/.*)?"


@contextmanager
def claimed_validation(folder: Path | None, recorded: Path | None = None) -> Generator[None]:
    """Hold a folder, if one is given, from before the work until `write_validation` has written.

    Raises `InputError` unless the folder is new, or holds nothing but an earlier validation, or if
    another process writes to it, or recordings of an earlier one that failed stand beside it, other
    than those of `recorded`, which are gone on with.
    """
    if folder is None:
        yield
        return
    with claimed_folder(folder, _ours(folder), "validate"):
        left = recordings_beside(folder)
        if left.exists() and (recorded is None or recorded.resolve() != left.resolve()):
            message = (
                "expected no recordings of an earlier validation, got some; use them with "
                f"--recorded {left}, or remove them"
            )
            raise InputError(message, path=left)
        yield


def recordings_beside(folder: Path) -> Path:
    """Return where recordings stand until the folder of their validation is written."""
    return folder.with_name(f"{folder.name}.{RECORDINGS}")


def _ours(folder: Path) -> str:
    # Without a result the folders may be somebody's: their names are common words.
    return _OURS if (folder / _RESULT).exists() else ""


def write_validation(
    folder: Path,
    validation: Validation,
    names: Sequence[str],
    series: Mapping[int, Series],
    recordings: Path,
) -> None:
    """Write a folder whole: recordings, simulated replays, the record and the page.

    Recordings that stood beside it are removed once it is in place.

    Parameters
    ----------
    names
        Of the cases' folders.
    recordings
        A folder of recordings, which are copied.

    Raises
    ------
    InputError
        As `claimed_validation`.
    """
    require_replaceable(folder, _ours(folder), "validate")
    with whole_folder(folder) as partial:
        for number, by_label in series.items():
            _write_simulated(partial / _SIMULATED / names[number], by_label)
        for name in names:
            if (recordings / name).is_dir():
                shutil.copytree(recordings / name, partial / RECORDINGS / name)
        (partial / _RESULT).write_bytes(encode_record(validation))
        (partial / _REPORT).write_text(render_validation(validation, series), encoding="utf-8")
    shutil.rmtree(recordings_beside(folder), ignore_errors=True)


def _write_simulated(folder: Path, series: Series) -> None:
    folder.mkdir(parents=True)
    for label, name in frame_log_names(list(series)).items():
        write_frame_log(folder / name, series[label][1])
