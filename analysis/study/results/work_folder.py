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

    What cannot be written is no reason to stop: the study goes on without.
    The caller holds the target (`locked`).

    Attributes
    ----------
    runs : RunList
        The study.
    results : dict of int to Scored or Failure
        What an earlier start of the same study has left, by position.
    missing : list of int
        Positions of the runs that are yet to be carried out.
    watch : Stopwatch
    """

    def __init__(self, target: Path, runs: RunList) -> None:
        self.runs = runs
        self.results: dict[int, Scored | Failure] = {}
        self.missing = list(range(len(runs)))
        self._path = work_path(target)
        self._store: ResultStore | None = None
        try:
            self._store = ResultStore.open(self._path, runs, replaces=True)
            self.results = dict(self._store.results())
            self.missing = self._store.missing
        except (InputError, OSError):
            self._store = None
        self._kept = 0
        self.watch = Stopwatch(self._path, runs.digest)

    @property
    def durable(self) -> int:
        """The number of results that no end of the process can take back."""
        return self._kept if self._store is None else self._store.durable

    def add(self, at: int, outcome: Outcome) -> None:
        """Keep what became of the run at a position of the study."""
        self.watch.add(self.runs.runs[at].owner, outcome)
        if self._store is not None:
            try:
                self._store.add(at, outcome)
            except (InputError, OSError):
                self._give_up()

    def flush(self) -> None:
        """Return when all that was added is on the disk, as far as it takes it."""
        if self._store is not None:
            try:
                self._store.flush()
            except (InputError, OSError):
                self._give_up()

    def close(self) -> int:
        """Put all that was added on the disk, and return the number of results that are kept.

        A folder without any is removed.
        """
        if self._store is not None:
            with suppress(InputError, OSError):
                self._store.close()
                self.watch.write(self._path)
            self._give_up()
        if not any(self._path.glob(f"{PARTS}/*.parquet")):
            shutil.rmtree(self._path, ignore_errors=True)
        return self._kept

    def _give_up(self) -> None:
        if self._store is not None:
            self._kept, self._store = self._store.durable, None


def remove_work(target: Path) -> None:
    """Remove what is kept for a target: it is done, or never will be."""
    shutil.rmtree(work_path(target), ignore_errors=True)
