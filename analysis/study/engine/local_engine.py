"""The engine of this machine."""

from collections.abc import Iterator, Sequence
from typing import Self

from ....base.errors import PolicyError
from .task import Failure, Inputs, NotApplicableError, Outcome, Task


class LocalEngine:
    """Carries out tasks here."""

    def __init__(self, inputs: Inputs, workers: int = 0) -> None:
        self._inputs, self._workers = inputs, workers

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def run(self, tasks: Sequence[Task], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield what became of each task (see `Engine`)."""
        stopped: set[str] = set()
        for index, task in enumerate(tasks):
            if task.owner in stopped:
                continue
            try:
                outcome = Outcome(index, task(self._inputs, _no_beat))
            except PolicyError as error:
                outcome = Outcome(index, None, Failure("failed", error.reason, error.frame))
            except NotApplicableError as error:
                outcome = Outcome(index, None, Failure("not-applicable", str(error)))
            if outcome.failure and stop:
                stopped.add(task.owner)
            yield outcome


def _no_beat(_frame: int) -> None:
    """Nobody watches."""
