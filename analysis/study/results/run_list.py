"""The runs of a study in their order, with all that a reader of their results wants to know."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from ....base.content_hash import content_hash
from ....base.errors import InputError
from ..engine.limits import DEFAULT_LIMITS, Limits
from ..run import Run
from .record import SCHEMA, AxisValue, schema_of

Axes: TypeAlias = Mapping[str, Sequence[AxisValue]]


@dataclass(frozen=True, slots=True, eq=False)
class RunList:
    """Runs, named by content hash.

    Raises `InputError` if a run is given twice, ValueError if an axis has not one value a run or
    the name of another column, and TypeError or OSError as `Run.digest` does.

    Attributes
    ----------
    runs : tuple of Run
    names : dict of str to str
        Of scenes, paths and hardware, by content hash.
    axes : dict of str to sequence
        By the name of an axis, its value in each run: columns of their own in the results, beside
        those that every result has (`record.COLUMNS`).  Values of one axis are of one kind.
    stop : bool
        Whether the runs of an owner behind its first failure count for nothing (see `Engine.run`).
    limits : Limits
        What policies may take, on which it depends which fail.
    study : str
        What names the study where its runs alone do not: it asks for more of them as results
        come.  Empty for the hash of the runs.
    digests : tuple of str
        Of the runs.
    digest : str
        Of the study: `study`, or of its runs and of all that is said beside them.
    """

    runs: tuple[Run, ...]
    names: Mapping[str, str]
    axes: Axes = field(default_factory=dict[str, Sequence[AxisValue]])
    stop: bool = False
    limits: Limits = DEFAULT_LIMITS
    study: str = ""
    digests: tuple[str, ...] = field(init=False)
    digest: str = field(init=False)

    def __post_init__(self) -> None:
        for name, values in self.axes.items():
            if len(values) != len(self.runs):
                raise ValueError(f"axis {name}: {len(values)} values for {len(self.runs)} runs")
        schema_of(self.axes)
        digests = tuple(run.digest for run in self.runs)
        twice = len(digests) - len(set(digests))
        if twice:
            raise InputError(f"study: expected each run once, got {twice} again; leave them out")
        object.__setattr__(self, "digests", digests)
        axes = {name: list(values) for name, values in self.axes.items()}
        known = content_hash(SCHEMA, list(digests), dict(self.names), axes, self.stop, self.limits)
        object.__setattr__(self, "digest", self.study or known)

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.runs)

    def wanted(self, failed: Mapping[int, bool]) -> list[int]:
        """Return which runs count when some have failed, by their positions.

        Parameters
        ----------
        failed
            Of each run that is finished, by position, whether it failed.
        """
        if not self.stop:
            return list(range(len(self)))
        stopped: set[str] = set()
        kept: list[int] = []
        for at, run in enumerate(self.runs):
            if run.owner in stopped:
                continue
            kept.append(at)
            if failed.get(at, False):
                stopped.add(run.owner)
        return kept
