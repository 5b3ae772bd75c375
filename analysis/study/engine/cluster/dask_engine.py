"""The engine of a Dask cluster: the same processes as on one machine, beside each Dask worker.

A worker that is lost loses what it was doing, which is done again elsewhere.  A scheduler that is
lost is tried for a minute; what has been told by then is told once.
"""

import queue
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, Self

from .....base.errors import InputError
from .....base.portable_pickle import portable_pickle
from .....policies.registry import REGISTERED
from ..limits import Limits
from ..local.shared_file import SharedInputs
from ..task import Failure, Inputs, Outcome, Task
from .batches import Batches
from .dask_cluster import LOST, Cluster, QuietDask
from .dask_worker import Answer, Batch, ClosedTask, carry_out
from .sent_inputs import SentInputs

AHEAD = 2
"""Batches for each thread of the cluster: one that is carried out, one that waits."""

_SETBACKS = 5  # in a row, without an outcome between them, after which a study is given up
_LOOK_S = 1.0


class DaskEngine:
    """Carries out tasks on a Dask cluster.

    Parameters
    ----------
    inputs
        What tasks share.  It is sent to the cluster once, and from worker to worker.
    scheduler
        See `Cluster`.
    limits
        What a policy may take.
    """

    def __init__(self, inputs: Inputs, scheduler: str, limits: Limits | None = None) -> None:
        self._inputs, self._limits = inputs, limits or Limits()
        self._cluster = Cluster(scheduler)
        self._quiet = QuietDask()
        self._sent: Any = None
        self._flying: dict[Any, list[int]] = {}
        self._landed: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._arrived: deque[Outcome] = deque()
        self._setbacks = 0

    def __enter__(self) -> Self:
        self._cluster.connect()
        self._quiet.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._sent = None
        self._cluster.close()
        self._quiet.stop()

    def run(self, tasks: Sequence[Task], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield what became of each task (see `Engine`)."""
        batches = Batches([task.owner for task in tasks], stop=stop)
        registered = _registered()
        try:
            while not batches.finished:
                lost: BaseException | None = None
                try:
                    self._hand_out(batches, tasks, registered, stop=stop)
                    self._collect(batches)
                except LOST as error:
                    lost = error
                while self._arrived:  # also what came in before the connection was lost
                    yield from batches.settle(self._arrived.popleft())
                if lost is not None:
                    self._recover(batches, lost)
                self._forget(batches)
        finally:
            self._cancel(list(self._flying))

    def _hand_out(
        self,
        batches: Batches,
        tasks: Sequence[Task],
        registered: dict[str, bytes],
        *,
        stop: bool,
    ) -> None:
        """Send batches until there are enough on their way."""
        if self._sent is None:
            self._send_inputs()
        slots = self._cluster.slots()
        while len(self._flying) < AHEAD * slots:
            indices = batches.take(slots)
            if not indices:
                return
            batch = Batch(
                tasks[indices[0]].owner,
                tuple(_close(tasks[index], registered) for index in indices),
                stop,
                self._limits,
                self._cluster.versions,
            )
            try:
                future = self._cluster.client.submit(carry_out, self._sent, batch, pure=False)
            except LOST:
                batches.put_back(indices)
                raise
            self._flying[future] = indices
            future.add_done_callback(self._landed.put)

    def _send_inputs(self) -> None:
        self._cluster.check_workers()
        sent = SentInputs(SharedInputs(self._inputs))
        self._sent = self._cluster.client.scatter(sent, hash=False)

    def _collect(self, batches: Batches) -> None:
        """Wait for what lands, for a moment at most, and keep its outcomes."""
        landed: list[Any] = []
        with suppress(queue.Empty):
            landed.append(self._landed.get(timeout=_LOOK_S))
            while True:
                landed.append(self._landed.get_nowait())
        landed = [future for future in landed if future in self._flying]
        if not landed and not self._cluster.connected:
            raise OSError("the scheduler has gone")
        for future in landed:
            if future.status != "finished":
                self._lose(future, batches)
        done = [future for future in landed if future.status == "finished"]
        answers: list[Answer] = self._cluster.client.gather(done) if done else []
        for future, answer in zip(done, answers, strict=True):
            indices = self._flying.pop(future)
            if answer.refusal is not None:
                raise answer.refusal
            self._arrived += [_at(indices, outcome) for outcome in answer.outcomes]
            self._setbacks = 0

    def _lose(self, future: Any, batches: Batches) -> None:
        """Put back a batch that was not carried out, or fail it if it ends whoever tries."""
        from distributed import KilledWorker

        if future.status != "error":
            raise OSError("what was to be done has been cancelled")
        error: Any = future.exception()
        indices = self._flying.pop(future)
        if not isinstance(error, KilledWorker):
            batches.put_back(indices)
            self._count(error)
        elif len(indices) > 1:  # which of them it was is found out one by one
            batches.put_back(indices)
        else:
            reason = "Dask workers ended one after the other while they ran it; see their logs"
            self._arrived.append(Outcome(indices[0], None, Failure("failed", reason)))
            self._setbacks = 0

    def _recover(self, batches: Batches, error: BaseException) -> None:
        """Put back what was on its way, and reach the cluster again."""
        for indices in self._flying.values():
            batches.put_back(indices)
        self._flying.clear()
        self._sent = None
        self._count(error)
        if not self._cluster.connected:
            self._cluster.reconnect()

    def _count(self, error: BaseException) -> None:
        self._setbacks += 1
        if self._setbacks > _SETBACKS:
            raise InputError(
                f"--scheduler {self._cluster.scheduler}: expected a cluster that does what it is "
                f"sent, got {type(error).__name__}: {error}; see the logs of its workers"
            ) from error

    def _forget(self, batches: Batches) -> None:
        """Cancel what nobody waits for any more."""
        self._cancel([it for it, indices in self._flying.items() if not batches.wants(indices)])

    def _cancel(self, futures: list[Any]) -> None:
        for future in futures:
            del self._flying[future]
        if futures and self._cluster.connected:
            with suppress(*LOST):
                self._cluster.client.cancel(futures)


def _close(task: Task, registered: dict[str, bytes]) -> ClosedTask:
    try:
        data = portable_pickle(task)
    except Exception as error:  # whatever the state of a user's object raises
        raise InputError(
            f"policy {task.owner}: expected a policy that other processes can load, got "
            f"{type(error).__name__}: {error}; put its class into a file"
        ) from error
    return ClosedTask(task.owner, getattr(task, "result_type", Any), data, registered)


def _registered() -> dict[str, bytes]:
    """Return the policies that a user has named, as far as they can be sent."""
    found: dict[str, bytes] = {}
    for name, cls in REGISTERED.users.items():
        with suppress(Exception):  # who needs it is told that there is none
            found[name] = portable_pickle(cls)
    return found


def _at(indices: list[int], outcome: Outcome) -> Outcome:
    return Outcome(
        indices[outcome.index],
        outcome.result,
        outcome.failure,
        outcome.took_s,
        outcome.peak_bytes,
    )
