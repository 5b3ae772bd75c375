"""Carry out a study: all of its runs, or what a folder of results lacks of them."""

import sys
from contextlib import suppress
from pathlib import Path

from ....base.errors import InputError
from ....base.files.whole_folder import claimed_folder
from ..engine.task import Engine
from ..results.manifest import OURS, read_manifest
from ..results.record import Entry, encode
from ..results.run_info import Stopwatch
from ..results.run_list import RunList
from ..results.store import ResultStore
from ..runs import Progress
from .study_results import StudyResults, read_study_results, results_of


def check_folder(folder: Path) -> None:
    """Raise `InputError` before the work if a folder is of somebody else or cannot be written."""
    with claimed_folder(folder, OURS, "sweep", make_parents=True):
        pass


def carry_out(
    name: str, runs: RunList, engine: Engine, progress: Progress | None = None
) -> StudyResults:
    """Carry out all runs, and return what became of each.

    Raises `InputError` if a worker cannot be reached, or the parameters of a policy are refused.
    """
    entries: list[Entry] = []
    with engine:
        for outcome in engine.run(runs.runs, stop=False):
            entries.append(Entry(outcome.index, outcome.failure or outcome.result))
            if progress is not None:
                progress(len(entries), len(runs))
    entries.sort(key=lambda entry: entry.at)
    return results_of(name, encode(runs, entries))


def carry_out_in(
    folder: Path,
    runs: RunList,
    engine: Engine,
    *,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> StudyResults:
    """Carry out the runs that a folder of results lacks, and return what became of all.

    What ends the process loses the runs of half a second at most.

    Raises `InputError` as `carry_out`, or if the folder holds another study, unless `overwrite`, or
    files of somebody else, or cannot be written.
    """
    with claimed_folder(folder, OURS, "sweep", make_parents=True):
        if not overwrite:
            _require_same(folder, runs)
        store = ResultStore.open(folder, runs, replaces=overwrite)
        try:
            with store:
                _complete(folder, runs, store, engine, progress)
        except BaseException:
            left = f"{store.durable:,} of {len(runs):,} runs are in {folder}"
            print(f"{left}; run the same command again to go on", file=sys.stderr)
            raise
        return read_study_results(folder)


def _complete(
    folder: Path, runs: RunList, store: ResultStore, engine: Engine, progress: Progress | None
) -> None:
    """Add what became of the missing runs, and put all in the order of the study."""
    missing = store.missing
    if missing:
        watch = Stopwatch(folder, runs.digest)
        with engine:
            for outcome in engine.run([runs.runs[at] for at in missing], stop=False):
                at = missing[outcome.index]
                watch.add(runs.runs[at].owner, outcome)
                store.add(at, outcome)
                if progress is not None:
                    progress(store.durable, len(runs))
        store.flush()
        watch.write(folder)
        if progress is not None:
            progress(len(runs), len(runs))
    store.finish()


def _require_same(folder: Path, runs: RunList) -> None:
    """Raise `InputError` if a folder holds another study."""
    manifest = None
    with suppress(InputError):  # a damaged one counts for nothing, as the store will say
        manifest = read_manifest(folder)
    if manifest is not None and manifest.study != runs.digest:
        raise InputError(
            "expected a new folder or results of this study, got another study's; name another "
            "folder, or take --overwrite",
            path=folder,
        )
