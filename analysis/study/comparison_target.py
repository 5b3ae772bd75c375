"""A folder on its way to a comparison: held, worked for, and written in one step.

A comparison that was stopped goes on where it was, and one that is done is not done again.
"""

import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ...base.errors import InputError
from ...base.files.whole_folder import claimed_folder
from .comparison_folder import OURS, Compared, holds_study, read_results, write_results
from .results.work_folder import WorkFolder, remove_work


@contextmanager
def claimed_target(folder: Path | None) -> Generator["ComparisonTarget | None"]:
    """Hold a folder, if one is given, from before the replays until the comparison is in place.

    What stops the block after it has begun leaves the runs that are done beside the folder, and
    says how to go on.

    Raises `InputError` if the folder holds files of somebody else, cannot be written, or another
    process writes to it.
    """
    if folder is None:
        yield None
        return
    with claimed_folder(folder, OURS, "compare", make_parents=True):
        target = ComparisonTarget(folder)
        try:
            yield target
        except InputError:  # its one line is all that is told
            target.stop()
            raise
        except BaseException:
            if kept := target.stop():
                print(f"{kept}; run the same command again to go on", file=sys.stderr)
            raise
        target.finish()


class ComparisonTarget:
    """The folder of one comparison.

    Attributes
    ----------
    work : WorkFolder or None
        Where the results of its runs are kept; None if they are not: it has not begun, is done, or
        has a policy without content to tell it by.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._study: str | None = None
        self._holds = False
        self.work: WorkFolder | None = None

    def begin(self, study: str | None) -> Compared | None:
        """Return the comparison if the folder holds it; else be ready to work.

        Parameters
        ----------
        study
            Hash of all that it depends on; None where a policy has no content to hash.
        """
        if study is None:
            return None
        self._study = study
        self._holds = holds_study(self._folder, study)
        if self._holds:
            told = f"{self._folder} holds this comparison: no run is repeated, unless you remove it"
            print(told, file=sys.stderr)
            return read_results(self._folder)
        self.work = WorkFolder(self._folder, study)
        return None

    def write(self, compared: Compared) -> None:
        """Put a comparison in place, unless it is there; raises `InputError` if it cannot be."""
        if not self._holds:
            watch = None if self.work is None else self.work.watch
            write_results(self._folder, compared, study=self._study, watch=watch)

    def stop(self) -> str:
        """Leave the runs that are done to the next start; return in words how many they are."""
        kept = 0 if self.work is None else self.work.close()
        if not kept:
            return ""
        return f"{kept:,} runs are kept" if kept > 1 else "1 run is kept"

    def finish(self) -> None:
        """Remove what was kept: the comparison is in place."""
        if self.work is not None:
            self.work.close()
        remove_work(self._folder)
