"""A folder on its way to a comparison: held, worked for, and written in one step.

A comparison that was stopped goes on where it was, and one that is done is not done again.
"""

import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ...base.content_hash import content_hash
from ...base.errors import InputError
from ...base.files.whole_folder import claimed_folder
from ...sim.frame_log import FrameLog
from .code_hash import package_hash
from .comparison import Comparison
from .comparison_folder import OURS, holds_study, read_results, write_results
from .results.run_list import RunList
from .results.work_folder import WorkFolder, remove_work
from .runs import Plan

if TYPE_CHECKING:
    from .engine.limits import Limits


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

    def begin(self, plan: Plan, limits: "Limits") -> tuple[Comparison, dict[str, FrameLog]] | None:
        """Return the comparison of these runs if the folder holds it; else be ready to work.

        Parameters
        ----------
        limits
            On which it depends which policies fail.
        """
        runs = _list_runs(plan, limits)
        if runs is None:
            return None
        self._study = content_hash(package_hash(), runs.digest)
        self._holds = holds_study(self._folder, self._study)
        if self._holds:
            told = f"{self._folder} holds this comparison: no run is repeated, unless you remove it"
            print(told, file=sys.stderr)
            return read_results(self._folder)
        self.work = WorkFolder(self._folder, runs)
        return None

    def write(self, comparison: Comparison, logs: dict[str, FrameLog]) -> None:
        """Put a comparison in place, unless it is there; raises `InputError` if it cannot be."""
        if not self._holds:
            watch = None if self.work is None else self.work.watch
            write_results(self._folder, comparison, logs, study=self._study, watch=watch)

    def stop(self) -> str:
        """Leave the runs that are done to the next start; return in words how many they are."""
        kept = 0 if self.work is None else self.work.close()
        return f"{kept} of {len(self.work.runs)} runs are kept" if self.work and kept else ""

    def finish(self) -> None:
        """Remove what was kept: the comparison is in place."""
        if self.work is not None:
            self.work.close()
        remove_work(self._folder)


def _list_runs(plan: Plan, limits: "Limits") -> RunList | None:
    """Return the study of these runs, None if one has no content to tell it by."""
    names = {digest: value.name for digest, value in plan.inputs.items()}
    try:
        return RunList(plan.runs, names, stop=True, limits=limits)
    except TypeError:
        return None
