"""The engine of this machine: worker processes, each of which runs one policy."""

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from selectors import EVENT_READ, EVENT_WRITE, DefaultSelector
from typing import Self

from .....base.errors import InputError
from .....base.foreign_text import one_line
from .....base.portable_pickle import portable_pickle
from .....policies.registry import REGISTERED
from ..limits import Limits, count_processors
from ..schedule import Schedule
from ..task import Failure, Inputs, Outcome, Task
from .messages import GarbledError, Message
from .processes import Worker, end_all
from .shared_file import SharedInputs
from .watch import SLACK_BYTES, Verdict, Watch
from .worker import CLOSED, here

_TICK_S = 0.1
_GRACE_S = 1.0
_STARTS = 3
_CLOSED = "its process closed what it answers through"
_GARBLED = "its process sent what is no result"
_MOST_REASON = 1000  # characters
_LINES, _WIDTH = 20, 200  # of what a policy printed


class LocalEngine:
    """Carries out tasks in processes of this machine.

    A process carries out tasks of one owner only, and is replaced where another's are next.  What a
    policy does to its process, the process ending, hanging or growing beyond its limit included,
    fails that policy.  What policies print is caught, and its end printed on stderr at the end.

    Parameters
    ----------
    inputs
        What tasks share.  It reaches workers as one file, of which they have a map that cannot be
        written.  A file that is given stays open when the engine is left.
    workers
        Processes at most; 0 for as many as there are processors.
    limits
        What a policy may take.
    """

    def __init__(
        self, inputs: Inputs | SharedInputs, workers: int = 0, limits: Limits | None = None
    ) -> None:
        self._inputs, self._limits = inputs, limits or Limits()
        self._most = workers or count_processors()
        self._shared: SharedInputs | None = None
        self._workers: list[Worker] = []
        self._printed: dict[str, bytes] = {}
        self._failed_starts = 0
        self._killed = Counter[int]()
        self._interrupted = False

    def __enter__(self) -> Self:
        given = self._inputs
        self._shared = given if isinstance(given, SharedInputs) else SharedInputs(given)
        return self

    def __exit__(self, *exception: object) -> None:
        self._end(list(self._workers))
        if self._shared is not None and self._shared is not self._inputs:
            self._shared.close()
        self._shared = None
        for owner, text in self._printed.items():
            for line in text.decode(errors="replace").splitlines()[-_LINES:]:
                if sys.stderr is not None:  # a program without a terminal may have none
                    print(f"{owner} printed: {line[:_WIDTH]}", file=sys.stderr)
        self._printed.clear()

    def run(self, tasks: Sequence[Task], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield what became of each task (see `Engine`).

        Raises InterruptedError after `interrupt`.
        """
        assert self._shared is not None, "an engine is entered before it runs"
        self._tasks = tasks
        self._killed.clear()
        self._schedule = Schedule([task.owner for task in tasks], stop=stop)
        memory_bytes = self._limits.worker_bytes(max(min(self._most, len(tasks)), 1))
        self._memory_bytes, shared_bytes = memory_bytes, sum(self._shared.sizes)
        self._watch = Watch(self._limits, memory_bytes, shared_bytes)
        try:
            while not self._schedule.finished:
                if self._interrupted:
                    raise InterruptedError("nobody waits for this any more")
                self._assign()
                for outcome in self._wait():
                    yield from self._schedule.finish(outcome)
                self._end([item for item in self._workers if self._works_in_vain(item)])
        finally:
            # The caller may have gone away, or heard enough.
            self._end([worker for worker in self._workers if worker.queue])

    def interrupt(self) -> None:
        """Kill what runs, and have `run` raise at once; may be called from any thread."""
        self._interrupted = True  # first: what is killed from outside would be repeated
        for worker in list(self._workers):
            worker.kill()

    def _assign(self) -> None:
        """Give every worker something to do, and one task more where there are plenty."""
        schedule = self._schedule
        for worker in self._workers:
            if not worker.queue and self._takes(worker):
                self._give(worker)
        while schedule.waiting:
            if len(self._workers) >= self._most:
                idle = [worker for worker in self._workers if not worker.queue]
                if not idle:
                    break
                self._end(idle[:1])
            owner = schedule.choose(worker.owner for worker in self._workers)
            assert owner is not None, "a task waits"
            self._workers.append(self._start(owner))
            self._give(self._workers[-1])
        for worker in self._workers:
            # Near the end, what is queued here could be begun by another.
            plenty = schedule.waiting >= len(self._workers)
            if plenty and len(worker.queue) == 1 and self._takes(worker):
                self._give(worker)

    def _takes(self, worker: Worker) -> bool:
        fit = not worker.deaf and not self._watch.condemned(worker)
        return fit and self._schedule.waits(worker.owner)

    def _start(self, owner: str) -> Worker:
        assert self._shared is not None, "an engine is entered before it runs"
        registered: dict[str, bytes] = {}
        for name, cls in REGISTERED.users.items():
            try:
                registered[name] = portable_pickle(cls)
            except Exception:  # noqa: BLE001, S112 - who needs it is told that there is none
                continue
        setup = here(self._shared.sizes, registered, self._memory_bytes)
        most_bytes = self._memory_bytes + sum(self._shared.sizes) + SLACK_BYTES
        return Worker(owner, self._shared.fd, portable_pickle(setup), most_bytes)

    def _give(self, worker: Worker) -> None:
        task = self._schedule.take(worker.owner)
        try:
            data = portable_pickle(self._tasks[task])
        except Exception as error:  # whatever the state of a user's object raises
            raise InputError(
                f"policy {worker.owner}: expected a policy that other processes can load, got "
                f"{type(error).__name__}: {error}; keep files, locks and the like out of its state"
            ) from error
        worker.give(task, data)

    def _wait(self) -> list[Outcome]:
        """Return what has come in; waits for a moment at most."""
        with DefaultSelector() as selector:
            for worker in self._workers:
                if not worker.deaf:
                    events = EVENT_READ | (EVENT_WRITE if worker.sending else 0)
                    selector.register(worker.channel, events, worker)
                selector.register(worker.control, EVENT_READ, worker)
            ready = {key.data for key, _ in selector.select(_TICK_S)}
        found: list[Outcome] = []
        for worker in list(self._workers):
            if worker in ready:
                worker.flush()
                found += self._hear(worker)
                if worker.ended():
                    found += self._bury(worker)
                    continue
            self._watch.look(worker)
        return found

    def _hear(self, worker: Worker) -> list[Outcome]:
        """Return outcomes that a worker sent."""
        found: list[Outcome] = []
        try:
            found.extend(self._accept(worker, message) for message in worker.receive())
        except EOFError:
            worker.deaf = True
            self._watch.condemn(worker, _CLOSED, _GRACE_S)
        except GarbledError:
            worker.deaf = True
            self._watch.condemn(worker, _GARBLED)
        return found

    def _accept(self, worker: Worker, message: Message) -> Outcome:
        reply = message.reply
        if not worker.queue or reply.task != worker.queue[0]:
            raise GarbledError
        worker.queue.popleft()
        worker.since_ns = time.monotonic_ns()
        if reply.kind == "input":
            raise InputError(reply.reason, path=reply.path, line=reply.line)
        result, failure = None, None
        if reply.kind == "result":
            try:
                result = message.value(self._tasks[reply.task].result_type)
            except Exception:  # noqa: BLE001 - whatever is wrong with it, it is no result
                failure = Failure("failed", _GARBLED, reply.frame)
        elif reply.kind == "not-applicable":
            failure = Failure("not-applicable", one_line(reply.reason, _MOST_REASON))
        else:
            failure = Failure("failed", one_line(reply.reason, _MOST_REASON), reply.frame)
        return Outcome(reply.task, result, failure, reply.took_s, reply.peak_bytes)

    def _bury(self, worker: Worker) -> list[Outcome]:
        """Return what a worker that has ended leaves."""
        found = [] if worker.deaf else self._hear(worker)
        self._workers.remove(worker)
        verdict = self._watch.forget(worker)
        if not worker.pid:
            self._failed_starts += 1
            if self._failed_starts >= _STARTS:
                raise InputError("workers: expected processes that start, got none; ask for fewer")
        elif worker.queue and (verdict is None or verdict.task in (-1, worker.queue[0])):
            self._failed_starts = 0
            found.extend(self._blame(worker, verdict))
        self._schedule.give_back(worker.queue)
        self._keep_printed(worker)
        worker.close()
        return found

    def _blame(self, worker: Worker, verdict: Verdict | None) -> list[Outcome]:
        """Return the failure of the task that a worker ended in; nothing if it is repeated."""
        index = worker.queue[0]
        if verdict is not None and not self._ended_itself(worker, verdict):
            reason = verdict.reason
        elif worker.status in _FROM_OUTSIDE and self._killed[index] < _REPEATS:
            self._killed[index] += 1
            return []  # given back with the rest of the queue
        else:
            reason = _how_it_ended(worker.status)
        worker.queue.popleft()
        frame, _ = worker.heart.read(index)
        return [Outcome(index, None, Failure("failed", reason, frame))]

    def _ended_itself(self, worker: Worker, verdict: Verdict) -> bool:
        """Whether a worker that answers no more had come to its end by itself."""
        in_time = time.monotonic() < verdict.at_s or worker.status != _KILLED
        return verdict.reason == _CLOSED and in_time

    def _works_in_vain(self, worker: Worker) -> bool:
        """Whether nobody wants any more what a worker does."""
        return bool(worker.queue) and not any(map(self._schedule.wants, worker.queue))

    def _end(self, workers: list[Worker]) -> None:
        if not workers:
            return
        end_all(workers)
        for worker in workers:
            self._workers.remove(worker)
            self._watch.forget(worker)
            self._keep_printed(worker)

    def _keep_printed(self, worker: Worker) -> None:
        if worker.printed:
            self._printed[worker.owner] = self._printed.get(worker.owner, b"") + worker.printed


_KILLED = -9  # by SIGKILL, which not every system names
_FROM_OUTSIDE = (_KILLED, None)
"""How a worker ends that somebody else kills, or its minder; a policy may do the same to it..."""
_REPEATS = 2
"""...and so its run is repeated, but not for ever."""


def _how_it_ended(status: int | None) -> str:
    if status is None:
        return "its process was killed together with the one that minds it"
    if status == CLOSED:
        return _CLOSED
    if status >= 0:
        return f"process ended with status {status} before its result"
    try:
        return f"process ended by {signal.Signals(-status).name}"
    except ValueError:
        return f"process ended by signal {-status}"
