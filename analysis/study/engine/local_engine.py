"""The engine of this machine: worker processes, each of which runs one policy."""

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from selectors import EVENT_READ, EVENT_WRITE, DefaultSelector
from typing import Any, Self

import msgspec

from ....base.errors import InputError
from ....base.user_code import pickle_for_worker
from ....policies.registry import REGISTERED
from .limits import Limits, count_processors
from .memory import used_bytes
from .messages import GarbledError, Message
from .processes import Worker, end_all
from .schedule import Schedule
from .shared_file import SharedInputs
from .task import Failure, Inputs, Outcome, Task
from .worker import here

_TICK_S = 0.1
_GRACE_S = 1.0
_STARTS = 3
_FROM_OUTSIDE = {-signal.SIGKILL, None}
"""How a worker ends that somebody else kills, or its minder; a policy may do the same to it..."""
_REPEATS = 2
"""...and so its run is repeated, but not for ever."""
_SLACK_BYTES = 2**27
"""Of the interpreter and its modules, which the size of a process holds too."""


class LocalEngine:
    """Carries out tasks in processes of this machine.

    A process carries out tasks of one owner only, and is replaced where another's are next.  What a
    policy does to its process, the process ending, hanging or growing beyond its limit included,
    fails that policy.  What policies print is caught, and its end printed on stderr at the end.

    Parameters
    ----------
    inputs
        What tasks share.  It reaches workers as one file, of which they have a map that cannot be
        written.  A file that is given is left to the giver.
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
        self._verdicts: dict[Worker, tuple[int, str, float]] = {}
        self._printed: dict[str, bytes] = {}
        self._memory_bytes = 0
        self._failed_starts = 0
        self._killed = Counter[int]()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        workers, self._workers = self._workers, []
        end_all(workers)
        for worker in workers:
            self._keep_printed(worker)
        if self._shared is not None and self._shared is not self._inputs:
            self._shared.close()
        self._shared = None
        for owner, text in self._printed.items():
            for line in text.decode(errors="replace").splitlines()[-20:]:
                print(f"{owner} printed: {line}", file=sys.stderr)
        self._printed.clear()

    def run(self, tasks: Sequence[Task], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield what became of each task (see `Engine`)."""
        schedule = Schedule([task.owner for task in tasks], stop=stop)
        self._killed.clear()
        if self._shared is None:
            given = self._inputs
            self._shared = given if isinstance(given, SharedInputs) else SharedInputs(given)
            self._memory_bytes = self._limits.worker_bytes(max(min(self._most, len(tasks)), 1))
        try:
            while not schedule.finished:
                self._assign(schedule, tasks)
                for outcome in self._wait(schedule, tasks):
                    yield from schedule.finish(outcome)
                self._dismiss(schedule)
        finally:
            self._end([worker for worker in self._workers if worker.queue])

    def interrupt(self) -> None:
        """Kill what runs, so that its tasks fail; may be called from any thread."""
        for worker in list(self._workers):
            worker.kill()

    def _assign(self, schedule: Schedule, tasks: Sequence[Task]) -> None:
        """Give every worker something to do, and one task more where there are plenty."""
        for worker in self._workers:
            if not worker.queue and worker not in self._verdicts and schedule.waits(worker.owner):
                self._give(worker, schedule, tasks)
        while schedule.waiting:
            if len(self._workers) >= self._most:
                idle = [item for item in self._workers if not item.queue]
                if not idle:
                    break
                self._end(idle[:1])
            owner = schedule.choose(worker.owner for worker in self._workers)
            assert owner is not None, "a task waits"
            self._workers.append(self._start(owner))
            self._give(self._workers[-1], schedule, tasks)
        for worker in self._workers:
            plenty = schedule.waiting >= len(self._workers)
            if plenty and len(worker.queue) == 1 and schedule.waits(worker.owner):
                self._give(worker, schedule, tasks)

    def _start(self, owner: str) -> Worker:
        assert self._shared is not None, "inputs are shared before the first worker"
        registered: dict[str, bytes] = {}
        for name, cls in REGISTERED.users.items():
            try:
                registered[name] = pickle_for_worker(cls)
            except Exception:  # noqa: BLE001, S112 - who needs it is told that there is none
                continue
        setup = here(self._shared.sizes, registered, self._memory_bytes)
        most_bytes = self._memory_bytes + sum(self._shared.sizes) + _SLACK_BYTES
        return Worker(owner, self._shared.fd, pickle_for_worker(setup), most_bytes)

    def _give(self, worker: Worker, schedule: Schedule, tasks: Sequence[Task]) -> None:
        task = schedule.take(worker.owner)
        try:
            data = pickle_for_worker(tasks[task])
        except Exception as error:  # whatever the state of a user's object raises
            raise InputError(
                f"policy {worker.owner}: expected a policy that other processes can load, got "
                f"{type(error).__name__}: {error}; put its class into a file"
            ) from error
        worker.give(task, data)

    def _wait(self, schedule: Schedule, tasks: Sequence[Task]) -> list[Outcome]:
        """Return what has come in; waits for a moment at most."""
        with DefaultSelector() as selector:
            for worker in self._workers:
                events = EVENT_READ | (EVENT_WRITE if worker.sending else 0)
                selector.register(worker.channel, events, worker)
                selector.register(worker.control, EVENT_READ, worker)
            ready = {key.data for key, _ in selector.select(_TICK_S)}
        found: list[Outcome] = []
        for worker in list(self._workers):
            if worker in ready:
                worker.flush()
                found += self._hear(worker, tasks)
                if worker.ended():
                    found += self._bury(worker, schedule, tasks)
                    continue
            self._watch(worker)
        return found

    def _hear(self, worker: Worker, tasks: Sequence[Task]) -> list[Outcome]:
        """Return outcomes that a worker sent."""
        found: list[Outcome] = []
        try:
            for message in worker.receive():
                found.append(self._accept(worker, message, tasks))
        except EOFError:
            self._condemn(worker, "its process closed what it answers through", _GRACE_S)
        except GarbledError:
            self._condemn(worker, "its process sent what is no result")
        return found

    def _accept(self, worker: Worker, message: Message, tasks: Sequence[Task]) -> Outcome:
        reply = message.reply
        if not worker.queue or reply.task != worker.queue[0]:
            raise GarbledError
        worker.queue.popleft()
        worker.since_ns = time.monotonic_ns()
        about = {"took_s": reply.took_s, "peak_bytes": reply.peak_bytes}
        if reply.kind == "input":
            raise InputError(reply.reason, path=reply.path, line=reply.line)
        if reply.kind == "result":
            try:
                kind: Any = getattr(tasks[reply.task], "result_type", Any)
                return Outcome(reply.task, message.value(kind), **about)
            except Exception:  # noqa: BLE001 - whatever is wrong with it, it is no result
                failure = Failure("failed", "its process sent what is no result")
        else:
            kind = "not-applicable" if reply.kind == "not-applicable" else "failed"
            failure = Failure(kind, reply.reason, reply.frame)
        return Outcome(reply.task, None, failure, **about)

    def _watch(self, worker: Worker) -> None:
        """Kill a worker that takes too long or too much."""
        if worker in self._verdicts:
            self._carry_out_verdict(worker)
            return
        if not worker.queue:
            return
        now_ns = time.monotonic_ns()
        frame, beat_ns = worker.heart.read(worker.queue[0])
        frames = 0 if frame is None else frame + 1
        still_s = (now_ns - max(beat_ns, worker.since_ns)) * 1e-9
        if still_s > self._limits.timeout_s:
            self._condemn(worker, f"no frame for {self._limits.timeout_s:g} s (--policy-timeout)")
        elif (now_ns - worker.since_ns) * 1e-9 > (most_s := self._limits.run_s(frames)):
            self._condemn(worker, f"{frames} frames took more than {most_s:.3g} s")
        elif worker.pid and self._shared is not None:
            most = self._memory_bytes + sum(self._shared.sizes) + _SLACK_BYTES
            if used_bytes(worker.pid) > most:
                gigabytes = self._memory_bytes / 1e9
                self._condemn(worker, f"more than {gigabytes:.2g} GB of memory (--policy-memory)")

    def _condemn(self, worker: Worker, reason: str, grace_s: float = 0.0) -> None:
        """Have a worker killed for what it does in its present task."""
        task = worker.queue[0] if worker.queue else -1
        if worker not in self._verdicts:
            self._verdicts[worker] = task, reason, time.monotonic() + grace_s
        self._carry_out_verdict(worker)

    def _carry_out_verdict(self, worker: Worker) -> None:
        late_s = time.monotonic() - self._verdicts[worker][2]
        if late_s >= 0.0:
            worker.kill()
        if late_s > 2.0:
            worker.force()

    def _bury(self, worker: Worker, schedule: Schedule, tasks: Sequence[Task]) -> list[Outcome]:
        """Return what a worker that has ended leaves."""
        found = self._hear(worker, tasks)
        self._workers.remove(worker)
        self._keep_printed(worker)
        task, reason, when = self._verdicts.pop(worker, (-1, "", 0.0))
        if not worker.began:
            self._failed_starts += 1
            if self._failed_starts >= _STARTS:
                raise InputError("workers: expected processes that start, got none; ask for fewer")
        elif worker.queue and task in (-1, worker.queue[0]):
            index = worker.queue[0]
            if not reason and worker.status in _FROM_OUTSIDE and self._killed[index] < _REPEATS:
                self._killed[index] += 1  # and given back with the rest of the queue
            else:
                if not reason or (worker.status is not None and time.monotonic() < when):
                    reason = _how_it_ended(worker.status)
                worker.queue.popleft()
                frame, _ = worker.heart.read(index)
                found.append(Outcome(index, None, Failure("failed", reason, frame)))
        schedule.give_back(worker.queue)
        worker.close()
        return found

    def _dismiss(self, schedule: Schedule) -> None:
        """End workers whose tasks nobody wants any more."""
        idle = [
            worker
            for worker in self._workers
            if worker.queue and not any(map(schedule.wants, worker.queue))
        ]
        self._end(idle)

    def _end(self, workers: list[Worker]) -> None:
        if not workers:
            return
        end_all(workers)
        for worker in workers:
            self._workers.remove(worker)
            self._verdicts.pop(worker, None)
            self._keep_printed(worker)

    def _keep_printed(self, worker: Worker) -> None:
        if worker.printed:
            self._printed[worker.owner] = self._printed.get(worker.owner, b"") + worker.printed


def _how_it_ended(status: int | None) -> str:
    if status is None:
        return "its process ended, and what minds it too"
    if status >= 0:
        return f"process ended with status {status} before its result"
    try:
        return f"process ended by {signal.Signals(-status).name}"
    except ValueError:
        return f"process ended by signal {-status}"
