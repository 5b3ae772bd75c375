"""Which task is next for whom, and which outcomes may be told."""

from collections import Counter, deque
from collections.abc import Iterable, Sequence

from .task import Outcome


class Schedule:
    """The tasks of one call, by owner and in the order given.

    With `stop`, an outcome is held back until all earlier tasks of its owner have one, so that what
    is told does not depend on which of them was finished first.
    """

    def __init__(self, owners: Sequence[str], *, stop: bool) -> None:
        self._owners, self._stop = owners, stop
        self._waiting: dict[str, deque[int]] = {}
        for index, owner in enumerate(owners):
            self._waiting.setdefault(owner, deque()).append(index)
        self._untold = {owner: deque(tasks) for owner, tasks in self._waiting.items()}
        # Counted, since a study may have as many owners as runs and asks at every turn.
        self._waiting_count = len(owners)
        self._held: dict[int, Outcome] = {}
        self._left = len(owners)  # tasks that are neither told nor dropped

    @property
    def finished(self) -> bool:
        """Whether every task has been told or dropped."""
        return self._left == 0

    @property
    def waiting(self) -> int:
        """Number of tasks that nobody has taken."""
        return self._waiting_count

    def waits(self, owner: str) -> bool:
        """Whether the owner has a task that nobody has taken."""
        return bool(self._waiting.get(owner))

    def choose(self, busy: Iterable[str]) -> str | None:
        """Return the owner that a new process helps most: most tasks for each process it has."""
        count = Counter(busy)
        owners = [owner for owner, tasks in self._waiting.items() if tasks]
        return max(
            owners, key=lambda owner: len(self._waiting[owner]) / (1 + count[owner]), default=None
        )

    def take(self, owner: str) -> int:
        """Return the owner's next task, which is then somebody's."""
        task = self._waiting[owner].popleft()
        self._waiting_count -= 1
        return task

    def give_back(self, tasks: Iterable[int]) -> None:
        """Put back tasks that were taken and not begun, if they are still wanted."""
        for task in sorted(tasks, reverse=True):
            if self.wants(task):
                self._waiting[self._owners[task]].appendleft(task)
                self._waiting_count += 1

    def wants(self, task: int) -> bool:
        """Whether a task has neither an outcome nor been dropped."""
        return task in self._untold[self._owners[task]] and task not in self._held

    def finish(self, outcome: Outcome) -> list[Outcome]:
        """Take an outcome; return those that may now be told."""
        if not self.wants(outcome.index):  # it was under way when an earlier one failed
            return []
        owner = self._owners[outcome.index]
        untold = self._untold[owner]
        if not self._stop:
            untold.remove(outcome.index)
            self._left -= 1
            return [outcome]
        self._held[outcome.index] = outcome
        if outcome.failure is not None:
            self._drop_after(owner, outcome.index)
        told: list[Outcome] = []
        while untold and untold[0] in self._held:
            told.append(self._held.pop(untold.popleft()))
        self._left -= len(told)
        return told

    def _drop_after(self, owner: str, index: int) -> None:
        untold = self._untold[owner]
        while untold[-1] > index:
            self._held.pop(untold.pop(), None)
            self._left -= 1
        waiting = self._waiting[owner]
        self._waiting[owner] = kept = deque(task for task in waiting if task < index)
        self._waiting_count -= len(waiting) - len(kept)
