"""Results of a command that is still at work, in a hidden folder beside its target.

The next start of the same command goes on from them, and one of another command removes them.
"""

import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ....base.errors import InputError
from ....base.files.folder_lock import lock_path
from ..engine.task import Failure, Outcome
from .manifest import PARTS
from .run_info import Stopwatch
from .run_list import RunList
from .store import ResultStore

if TYPE_CHECKING:
    from ..score import Scored


def work_path(target: Path) -> Path:
    """Return the hidden folder of what is at work for a target."""
    return lock_path(Path(os.path.realpath(target))).with_suffix(".unfinished")


class WorkFolder:
    """Keeps the results of a study as they come, as long as the disk takes them.

    The study may ask for its runs in rounds, each of which depends on the results before::

        for runs in rounds:
            earlier = work.begin(runs)
            for at, outcome in missing_of(runs, earlier):
                work.add(at, outcome)
            work.flush()

    What cannot be written is no reason to stop: the study goes on without.
    The caller holds the target (`locked`).

    Attributes
    ----------
    study : str
        Names the study: every round's `RunList` has it.
    watch : Stopwatch
    """

    def __init__(self, target: Path, study: str) -> None:
        self.study = study
        self._path = work_path(target)
        self._runs: RunList | None = None
        self._store: ResultStore | None = None
        self._writable = True
        self._kept = 0
        self.watch = Stopwatch(self._path, study)

    @property
    def durable(self) -> int:
        """The number of results that no end of the process can take back."""
        return self._kept if self._store is None else self._store.rows

    def begin(self, runs: RunList) -> "dict[int, Scored | Failure]":
        """Be ready for the runs of a round; return what earlier starts left of them, by position.

        Raises ValueError if they are of another study.
        """
        if runs.digest != self.study:
            raise ValueError(f"expected runs of the study {self.study}, got {runs.digest}")
        self._close_store()
        self._runs = runs
        if not self._writable:
            return {}
        try:
            self._store = ResultStore.open(self._path, runs, replaces=True)
            return dict(self._store.results())
        except (InputError, OSError):
            self._give_up()
            return {}

    def add(self, at: int, outcome: Outcome) -> None:
        """Keep what became of the run at a position of the round."""
        if self._runs is None:
            raise ValueError("expected a round that has begun")
        self.watch.add(self._runs.runs[at].owner, outcome)
        if self._store is not None:
            try:
                self._store.add(at, outcome)
            except (InputError, OSError):
                self._give_up()

    def flush(self) -> None:
        """Return when all that was added is on the disk, or cannot be."""
        if self._store is not None:
            try:
                self._store.flush()
            except (InputError, OSError):
                self._give_up()

    def close(self) -> int:
        """Put all that was added on the disk, and return the number of results that are kept.

        A folder without any is removed.
        """
        self._close_store()
        with suppress(InputError, OSError):
            self.watch.write(self._path)
        if not any(self._path.glob(f"{PARTS}/*.parquet")):
            shutil.rmtree(self._path, ignore_errors=True)
        return self._kept

    def _close_store(self) -> None:
        if self._store is not None:
            try:
                self._store.close()
                self._kept = self._store.rows
            except (InputError, OSError):
                self._writable = False
            self._store = None

    def _give_up(self) -> None:
        if self._store is not None:
            self._kept = self._store.rows
        self._store, self._writable = None, False


def remove_work(target: Path) -> None:
    """Remove what is kept for a target: it is done, or never will be."""
    shutil.rmtree(work_path(target), ignore_errors=True)
