"""Which tasks travel together.

A message to a cluster costs some milliseconds, so short tasks of one owner travel together; long
ones travel alone, since what travels together is told together and lost together.
"""

from collections import deque
from collections.abc import Sequence

from ..schedule import Schedule
from ..task import Outcome

_BATCH_S = 0.3  # wall time that a batch is to take: progress is seen, and messages are few
_MOST = 32  # tasks in a batch: their results travel together, and hold a frame log each
_LATEST = 0.3  # weight of the latest task in what an owner's tasks are thought to take


class Batches:
    """The tasks of one call, handed out together as far as they are short."""

    def __init__(self, owners: Sequence[str], *, stop: bool) -> None:
        self._schedule = Schedule(owners, stop=stop)
        self._owners = owners
        self._in_turn = deque(dict.fromkeys(owners))
        self._alone: deque[int] = deque()
        self._took_s: dict[str, float] = {}

    @property
    def finished(self) -> bool:
        """Whether every task has been told or dropped."""
        return self._schedule.finished

    def take(self, slots: int) -> list[int]:
        """Return tasks of one owner to be carried out together; none if nothing is left.

        Owners come one after the other, so that few workers change from one to another.

        Parameters
        ----------
        slots
            How many batches are carried out at once: near the end they are small, so that no slot
            waits for another's long one.
        """
        while self._alone:
            index = self._alone.popleft()
            if self._schedule.wants(index):
                return [index]
        while self._in_turn and not self._schedule.waits(self._in_turn[0]):
            self._in_turn.popleft()
        if not self._in_turn:
            return []
        owner = self._in_turn[0]
        size = min(self._size(owner), max(1, self._schedule.waiting // (2 * slots)))
        batch: list[int] = []
        while len(batch) < size and self._schedule.waits(owner):
            batch.append(self._schedule.take(owner))
        return batch

    def put_back(self, indices: Sequence[int]) -> None:
        """Hand out again, one by one, what was lost on its way."""
        self._alone.extend(indices)

    def settle(self, outcome: Outcome) -> list[Outcome]:
        """Take in an outcome and return those that may be told now (see `Schedule`)."""
        if not self._schedule.wants(outcome.index):
            return []
        owner = self._owners[outcome.index]
        before = self._took_s.get(owner, outcome.took_s)
        self._took_s[owner] = before + _LATEST * (outcome.took_s - before)
        return self._schedule.finish(outcome)

    def wants(self, indices: Sequence[int]) -> bool:
        """Whether anybody waits for one of these tasks."""
        return any(map(self._schedule.wants, indices))

    def _size(self, owner: str) -> int:
        """Return how many tasks take about as long as a batch is to take."""
        took_s = self._took_s.get(owner)
        if took_s is None:
            return 1
        return max(1, min(_MOST, int(_BATCH_S / max(took_s, 1e-6))))
