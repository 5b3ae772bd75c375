"""The folder that a comparison is written to: all of it, or nothing."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ...base.content_hash import hash_bytes
from ...base.errors import InputError, about_file
from ...base.files.strict_json import encode_record, read_json
from ...base.files.text_file import read_bytes
from ...base.files.whole_file import write_whole
from ...base.files.whole_folder import require_replaceable, whole_folder
from ...models.scene.scene import Scene
from ...models.scene.scene_file import read_scene, write_scene
from ...sim.frame_log import FrameLog
from ...sim.frame_log_file import read_frame_log, write_frame_log
from ..report.render import render_report
from .comparison import Comparison, read_comparison
from .results.run_table import read_runs, write_runs

if TYPE_CHECKING:
    import pyarrow as pa

    from .results.run_info import Stopwatch

COMPARISON, RUNS, SCENE = "comparison.json", "runs.parquet", "scene.lodscene"
"""Names of the record, of all runs and of the scene without its meshes in such a folder."""

_REPORT, _FRAMES, _MOMENTS, _STUDY = "report.html", "frames", "moments", "study.json"
_INFO = "run-info.json"
_STUDY_SCHEMA = "lodbench.comparison-folder/1"
_PNG, _MOST_PICTURE_BYTES = b"\x89PNG\r\n\x1a\n", 1_000_000
"""How a picture begins, and how large it may be: twenty times what most are."""

OURS = (
    r"report\.html|comparison\.json|runs\.parquet|scene\.lodscene|study\.json|run-info\.json"
    r"|frames(/.*\.parquet)?|moments(/.*\.png)?"
)
"""The names in such a folder."""


@dataclass(frozen=True, slots=True, eq=False)
class Compared:
    """A comparison and what it was made from.

    Attributes
    ----------
    comparison : Comparison
    logs : dict of str to FrameLog
        Of every scored policy on the first path, by label.
    runs : pa.Table or None
        A row for each replay, see `Replays.to_table`.
    scene : Scene or None
        Whose nodes the logs keep the levels of.
    pictures : dict of str to bytes
        PNG of what the camera saw at the worst moments of some policies, by label.
    """

    comparison: Comparison
    logs: dict[str, FrameLog]
    runs: "pa.Table | None"
    scene: Scene | None = None
    pictures: dict[str, bytes] = field(default_factory=dict[str, bytes])


@dataclass(frozen=True, slots=True)
class Study:
    """What a folder is the result of, and what it holds for that: ``study.json``.

    Attributes
    ----------
    study : str
        Hash of all runs and of the code.
    files : dict of str to str
        Hash of each file by its name in the folder, but for this one and ``run-info.json``.
    """

    study: str
    files: dict[str, str]
    schema: Literal["lodbench.comparison-folder/1"] = _STUDY_SCHEMA


def check_target(folder: Path) -> None:
    """Raise InputError unless a folder can be made, or holds nothing but an earlier comparison."""
    require_replaceable(folder, OURS, "compare", make_parents=True)


def frame_log_names(labels: list[str]) -> dict[str, str]:
    """Return a file name for the frames of each policy, distinct on every file system."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for label in sorted(labels):  # the same, whoever lists them
        stem = base = re.sub(r"[^\w.=,+-]+", "_", label)[:100]
        again = 2
        while stem.lower() in taken:
            stem, again = f"{base}-{again}", again + 1
        taken.add(stem.lower())
        names[label] = f"{stem}.parquet"
    return names


def write_results(
    folder: Path,
    compared: Compared,
    *,
    study: str | None = None,
    watch: "Stopwatch | None" = None,
) -> None:
    """Write report, comparison, runs and frame logs to a temporary folder, then put it in place.

    Parameters
    ----------
    study
        Hash by which `holds_study` is to know it.
    watch
        What the study took, for ``run-info.json``.

    Raises
    ------
    InputError
        As `check_target`.
    """
    check_target(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with whole_folder(folder) as partial:
        (partial / _FRAMES).mkdir()
        for label, name in frame_log_names(list(compared.logs)).items():
            write_frame_log(partial / _FRAMES / name, compared.logs[label])
        (partial / COMPARISON).write_bytes(encode_record(compared.comparison))
        if compared.runs is not None:
            write_runs(partial / RUNS, compared.runs)
        if compared.scene is not None:
            write_scene(partial / SCENE, compared.scene, ())
        if compared.pictures:
            (partial / _MOMENTS).mkdir()
            for label, name in _picture_names(compared.comparison).items():
                if label in compared.pictures:
                    (partial / _MOMENTS / name).write_bytes(compared.pictures[label])
        (partial / _REPORT).write_text(_page(compared), encoding="utf-8")
        if study is not None:
            (partial / _STUDY).write_bytes(encode_record(Study(study, _hash_files(partial))))
        if watch is not None:
            watch.write(partial)


def holds_study(folder: Path, study: str) -> bool:
    """Whether a folder holds all that `write_results` wrote of a study, and nothing else."""
    try:
        written = read_json(folder / _STUDY, Study, _STUDY_SCHEMA, "")
        return written.study == study and written.files == _hash_files(folder)
    except (InputError, OSError):  # it holds none, or what cannot be read
        return False


def _hash_files(folder: Path) -> dict[str, str]:
    """Return the hash of each file by its name, in order."""
    paths = sorted(path for path in folder.rglob("*") if not path.is_dir())
    names = [path.relative_to(folder).as_posix() for path in paths]
    return {
        name: hash_bytes(path.read_bytes())
        for name, path in zip(names, paths, strict=True)
        if name not in {_STUDY, _INFO}
    }


def read_results(folder: Path) -> Compared:
    """Read what `write_results` wrote.

    Raises `InputError` if a file is missing, broken, or of another run.
    """
    comparison = read_comparison(folder / COMPARISON)
    names = frame_log_names([policy.label for policy in comparison.ok])
    logs = {label: read_frame_log(folder / _FRAMES / name) for label, name in names.items()}
    for policy in comparison.ok:
        got = logs[policy.label].header
        if (got.policy, got.seed) != (policy.label, comparison.seed):
            raise InputError(
                f"expected frames of {policy.label}, seed {comparison.seed}, got frames of "
                f"{got.policy}, seed {got.seed}; run `lodbench compare` again",
                path=folder / _FRAMES / names[policy.label],
            )
    runs = read_runs(folder / RUNS) if (folder / RUNS).exists() else None
    scene = read_scene(folder / SCENE) if (folder / SCENE).exists() else None
    if scene is not None:
        for label, log in logs.items():
            with about_file(folder / _FRAMES / names[label]):
                if log.levels is not None:
                    log.levels.require_nodes(scene)
    return Compared(comparison, logs, runs, scene, _read_pictures(folder, comparison))


def _picture_names(comparison: Comparison) -> dict[str, str]:
    """Return the file of each scored policy's picture, of which few are there."""
    names = frame_log_names([policy.label for policy in comparison.ok])
    return {label: f"{name.removesuffix('.parquet')}.png" for label, name in names.items()}


def _read_pictures(folder: Path, comparison: Comparison) -> dict[str, bytes]:
    pictures: dict[str, bytes] = {}
    for label, name in _picture_names(comparison).items():
        path = folder / _MOMENTS / name
        if not path.exists():
            continue
        with about_file(path):
            pictures[label] = content = read_bytes(path, _MOST_PICTURE_BYTES)
            if not content.startswith(_PNG):
                raise InputError("expected a PNG, got another file; run `lodbench compare` again")
    return pictures


def _page(compared: Compared) -> str:
    return render_report(compared.comparison, compared.logs, compared.scene, compared.pictures)


def rewrite_report(folder: Path) -> Path:
    """Write the report of a folder again from its comparison and frame logs; return its path.

    Raises
    ------
    InputError
        As `read_results`.
    """
    compared = read_results(folder)
    target = folder / _REPORT
    write_whole(target, _page(compared))
    return target
