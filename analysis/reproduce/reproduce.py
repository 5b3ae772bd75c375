"""Carry out experiments on the study engine: trials that are done are not done again."""

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import msgspec

from ...base.errors import LodbenchError
from ...base.files.whole_file import write_whole
from ..study.code_hash import package_hash
from ..study.engine.limits import DEFAULT_LIMITS, Limits
from ..study.engine.open_engine import open_engine
from ..study.runs import Progress
from .experiment import Experiment
from .reproduction import Entry, Reproduction, Section
from .trial import Numbers, Trial

TRIALS = "trials"
"""Folder of the numbers of each trial, by its content hash."""


def reproduce(
    experiments: Sequence[Experiment],
    *,
    reduced: bool = False,
    out: Path | None = None,
    workers: int = 0,
    limits: Limits = DEFAULT_LIMITS,
    scheduler: str | None = None,
    command: str = "",
    progress: Progress | None = None,
) -> Reproduction:
    """Carry out experiments and judge them.

    Raises `LodbenchError` if a trial fails: an experiment without its numbers says nothing.

    Parameters
    ----------
    reduced
        Whether fewer frames, seeds and steps will do, as in tests.
    out
        Folder that keeps the numbers of trials; those of the same sources are not measured again.
    progress
        Told of trials done.
    """
    trials = {one.id: tuple(one.trials(reduced)) for one in experiments}
    wanted = list(dict.fromkeys(trial for some in trials.values() for trial in some))
    numbers = _measure(wanted, out, workers, limits, scheduler, progress)
    sections: list[Section] = []
    for one in experiments:
        findings = one.judge({trial.key: numbers[trial] for trial in trials[one.id]}, reduced)
        origins = {name: constant.origin for name, constant in one.constants.items()}
        entries = tuple(
            Entry(
                id=one.id,
                claim=claim.claim,
                paper=claim.paper,
                ours=claim.ours,
                tolerance=claim.tolerance,
                verdict=claim.verdict,
                constants=origins,
            )
            for claim in findings.claims
        )
        sections.append(Section(one, entries, findings.charts, findings.notes))
    return Reproduction(
        command=command,
        version=version("lodbench"),
        code=package_hash(),
        reduced=reduced,
        sections=tuple(sections),
    )


def _measure(
    trials: Sequence[Trial],
    out: Path | None,
    workers: int,
    limits: Limits,
    scheduler: str | None,
    progress: Progress | None,
) -> Mapping[Trial, Numbers]:
    """Return the numbers of trials, those that a folder has from there."""
    found = {trial: kept for trial in trials if (kept := _kept(trial, out)) is not None}
    missing = [trial for trial in trials if trial not in found]
    if progress is not None:
        progress(len(found), len(trials))
    if not missing:
        return found
    with open_engine({}, workers=workers, limits=limits, scheduler=scheduler) as engine:
        for outcome in engine.run(missing):
            trial = missing[outcome.index]
            if outcome.failure is not None:
                raise LodbenchError(f"reproduce {trial.function} {trial.key}: {outcome.failure}")
            found[trial] = outcome.result
            _keep(trial, outcome.result, out)
            if progress is not None:
                progress(len(found), len(trials))
    return found


def _kept(trial: Trial, out: Path | None) -> Numbers | None:
    """Return what a folder has of a trial; a damaged file counts as none."""
    if out is None:
        return None
    try:
        kept = (out / TRIALS / f"{trial.digest}.json").read_bytes()
        return msgspec.json.decode(kept, type=dict[str, Any])
    except (OSError, msgspec.MsgspecError):
        return None


def _keep(trial: Trial, numbers: Numbers, out: Path | None) -> None:
    if out is not None:
        folder = out / TRIALS
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / f"{trial.digest}.json", msgspec.json.encode(numbers))
