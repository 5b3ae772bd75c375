"""The folder that a comparison is written to: all of it, or nothing."""

import re
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ...base.errors import InputError
from ...base.strict_json import encode_record
from ...base.whole_file import write_whole
from ...base.whole_folder import claimed_folder, require_replaceable, whole_folder
from ...sim.frame_log import FrameLog
from ...sim.frame_log_file import read_frame_log, write_frame_log
from ..report.render import render_report
from .comparison import Comparison, read_comparison

_REPORT, _COMPARISON, _FRAMES = "report.html", "comparison.json", "frames"
_OURS = r"report\.html|comparison\.json|frames(/.*\.parquet)?"


def check_target(folder: Path) -> None:
    """Raise InputError unless a folder can be made, or holds nothing but an earlier comparison."""
    require_replaceable(folder, _OURS, "compare", make_parents=True)


@contextmanager
def claimed_target(folder: Path | None) -> Generator[None]:
    """Hold a folder, if one is given, from before the replays until `write_results` has written.

    Raises `InputError` as `check_target`, or if another process writes to the folder.
    """
    if folder is None:
        yield
        return
    with claimed_folder(folder, _OURS, "compare", make_parents=True):
        yield


def frame_log_names(labels: list[str]) -> dict[str, str]:
    """Return a file name for the frames of each policy, distinct on every file system."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for label in labels:
        stem = base = re.sub(r"[^\w.=,+-]+", "_", label)[:100]
        again = 2
        while stem.lower() in taken:
            stem, again = f"{base}-{again}", again + 1
        taken.add(stem.lower())
        names[label] = f"{stem}.parquet"
    return names


def write_results(folder: Path, comparison: Comparison, logs: dict[str, FrameLog]) -> None:
    """Write report, comparison and frame logs to a temporary folder, then put it in place.

    Raises
    ------
    InputError
        As `check_target`.
    """
    check_target(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with whole_folder(folder) as partial:
        (partial / _FRAMES).mkdir()
        for label, name in frame_log_names(list(logs)).items():
            write_frame_log(partial / _FRAMES / name, logs[label])
        (partial / _COMPARISON).write_bytes(encode_record(comparison))
        (partial / _REPORT).write_text(render_report(comparison, logs), encoding="utf-8")


def read_results(folder: Path) -> tuple[Comparison, dict[str, FrameLog]]:
    """Read what `write_results` wrote.

    Raises `InputError` if a file is missing, broken, or of another run.
    """
    comparison = read_comparison(folder / _COMPARISON)
    names = frame_log_names([policy.label for policy in comparison.ok])
    logs = {label: read_frame_log(folder / _FRAMES / name) for label, name in names.items()}
    for policy in comparison.ok:
        got = logs[policy.label].header
        if (got.policy, got.seed) != (policy.label, comparison.seed) or (
            len(logs[policy.label]) != policy.frames
        ):
            raise InputError(
                f"expected the {policy.frames} frames of {policy.label}, seed {comparison.seed}, "
                f"got {len(logs[policy.label])} of {got.policy}, seed {got.seed}; "
                "run `lodbench compare` again",
                path=folder / _FRAMES / names[policy.label],
            )
    return comparison, logs


def rewrite_report(folder: Path) -> Path:
    """Write the report of a folder again from its comparison and frame logs; return its path.

    Raises
    ------
    InputError
        As `read_results`.
    """
    comparison, logs = read_results(folder)
    target = folder / _REPORT
    write_whole(target, render_report(comparison, logs))
    return target
