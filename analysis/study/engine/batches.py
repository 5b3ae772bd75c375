"""Which tasks travel together, and which outcomes can be told already.

A message to a cluster costs some milliseconds, so short tasks of one owner travel together; long
ones travel alone, since what travels together is lost together.
"""

from collections import deque
from collections.abc import Sequence

from .task import Outcome

_BATCH_S = 0.3  # wall time that a batch is to take: progress is seen, and messages are few
_MOST = 32  # tasks in a batch: their results travel together, and hold a frame log each
_LATEST = 0.3  # weight of the latest task in what an owner's tasks are thought to take


class Batches:
    """The tasks that are left, by owner in the order given."""

    def __init__(self, owners: Sequence[str], *, stop: bool) -> None:
        self._owners, self._stop = owners, stop
        self._pending: dict[str, deque[int]] = {}
        for index, owner in enumerate(owners):
            self._pending.setdefault(owner, deque()).append(index)
        self._alone: deque[int] = deque()
        self._undelivered = len(owners)
        self._took_s: dict[str, float] = {}
        # With `stop` an outcome is held until those before it of its owner are there: only then is
        # it certain that no failure comes before it.
        self._untold = {owner: deque(indices) for owner, indices in self._pending.items()}
        self._held: dict[int, Outcome] = {}
        self._untold_count = len(owners)

    @property
    def finished(self) -> bool:
        """Whether all outcomes have been told."""
        return self._untold_count == 0

    def take(self, slots: int) -> list[int]:
        """Return tasks of one owner to be carried out together; none if nothing is left.

        Parameters
        ----------
        slots
            How many batches are carried out at once: near the end they are small, so that no slot
            waits for another's long one.
        """
        while self._alone:
            index = self._alone.popleft()
            if not self.is_moot(index):
                self._undelivered -= 1
                return [index]
        if not self._pending:
            return []
        owner, queue = next(iter(self._pending.items()))
        fair = max(1, self._undelivered // (2 * slots))
        size = min(self._size(owner), fair, len(queue))
        batch = [queue.popleft() for _ in range(size)]
        self._undelivered -= size
        if not queue:
            del self._pending[owner]
        return batch

    def put_back(self, indices: Sequence[int]) -> None:
        """Hand out again, one by one, what was lost on its way."""
        again = [index for index in indices if not self.is_moot(index)]
        self._alone.extend(again)
        self._undelivered += len(again)

    def settle(self, outcome: Outcome) -> list[Outcome]:
        """Take in an outcome and return those that can be told now."""
        owner = self._owners[outcome.index]
        before = self._took_s.get(owner, outcome.took_s)
        self._took_s[owner] = before + _LATEST * (outcome.took_s - before)
        if not self._stop:
            self._untold_count -= 1
            return [outcome]
        if self.is_moot(outcome.index):
            return []
        self._held[outcome.index] = outcome
        if outcome.failure is not None:
            self._drop_after(owner, outcome.index)
        untold, told = self._untold[owner], list[Outcome]()
        while untold and untold[0] in self._held:
            told.append(self._held.pop(untold.popleft()))
        self._untold_count -= len(told)
        return told

    def is_moot(self, index: int) -> bool:
        """Whether nobody waits for a task any more: it is done, or one before it has failed."""
        if not self._stop:
            return False
        untold = self._untold[self._owners[index]]
        return index in self._held or not untold or not untold[0] <= index <= untold[-1]

    def _drop_after(self, owner: str, failed: int) -> None:
        untold = self._untold[owner]
        while untold[-1] > failed:
            self._held.pop(untold.pop(), None)
            self._untold_count -= 1
        queue = self._pending.get(owner, deque())
        while queue and queue[-1] > failed:
            queue.pop()
            self._undelivered -= 1
        if not queue:
            self._pending.pop(owner, None)

    def _size(self, owner: str) -> int:
        """Return how many tasks take about as long as a batch is to take."""
        took_s = self._took_s.get(owner)
        if took_s is None:
            return 1
        return max(1, min(_MOST, int(_BATCH_S / max(took_s, 1e-6))))
