"""Limits on workers: what takes too long or too much is killed."""

import time
from dataclasses import dataclass

from ..limits import Limits
from .launch import SERVER
from .memory import used_bytes
from .processes import Worker

SLACK_BYTES = 2**27
"""Of the interpreter and its modules, which the size of a process holds beside what is limited."""

_LOOK_S = 0.1  # between looks at the memory of a process
_FORCE_S = 2.0  # until a minder is no longer waited for
_START_S = 30.0  # until the fork server is no longer waited for


@dataclass(frozen=True, slots=True)
class Verdict:
    """Why a worker is killed.

    Attributes
    ----------
    task : the task that it was at, -1 if it was at none
    reason : what the task failed of
    at_s : when, on the monotonic clock
    """

    task: int
    reason: str
    at_s: float


class Watch:
    """Watches the workers of one engine.

    Parameters
    ----------
    limits
        What a policy may take.
    memory_bytes
        Of these, what a worker may have.
    shared_bytes
        Size of the inputs, which each worker holds too.
    """

    def __init__(self, limits: Limits, memory_bytes: int, shared_bytes: int) -> None:
        self._limits, self._memory_bytes = limits, memory_bytes
        self._most_bytes = memory_bytes + shared_bytes + SLACK_BYTES
        self._verdicts: dict[Worker, Verdict] = {}
        self._looked_s: dict[Worker, float] = {}

    def condemned(self, worker: Worker) -> bool:
        """Whether a worker is about to be killed."""
        return worker in self._verdicts

    def look(self, worker: Worker) -> None:
        """Kill a worker that is beyond a limit, or whose verdict is due."""
        now_s = time.monotonic()
        if worker in self._verdicts:
            self._carry_out(worker, now_s - self._verdicts[worker].at_s)
        elif not worker.pid:
            if now_s - worker.started_s > _START_S:
                SERVER.restart()
                worker.give_up()
        elif worker.queue:
            reason = self._slow(worker) or self._large(worker, now_s)
            if reason is not None:
                self.condemn(worker, reason)

    def condemn(self, worker: Worker, reason: str, grace_s: float = 0.0) -> None:
        """Have a worker killed for what it does in its present task, if it does not end itself."""
        if worker not in self._verdicts:
            task = worker.queue[0] if worker.queue else -1
            self._verdicts[worker] = Verdict(task, reason, time.monotonic() + grace_s)
            self._carry_out(worker, -grace_s)

    def forget(self, worker: Worker) -> Verdict | None:
        """Watch a worker no longer; return why it was killed, if it was."""
        self._looked_s.pop(worker, None)
        return self._verdicts.pop(worker, None)

    def _slow(self, worker: Worker) -> str | None:
        frame, beat_ns = worker.heart.read(worker.queue[0])
        frames = 0 if frame is None else frame + 1
        now_ns = time.monotonic_ns()
        if (now_ns - max(beat_ns, worker.since_ns)) * 1e-9 > self._limits.timeout_s:
            return f"no frame for {self._limits.timeout_s:g} s (--policy-timeout)"
        most_s = self._limits.run_s(frames)
        if (now_ns - worker.since_ns) * 1e-9 > most_s:
            return f"{frames} frames took more than {most_s:.3g} s (--policy-timeout)"
        return None

    def _large(self, worker: Worker, now_s: float) -> str | None:
        if now_s - self._looked_s.get(worker, 0.0) < _LOOK_S:
            return None
        self._looked_s[worker] = now_s
        if used_bytes(worker.pid) <= self._most_bytes:
            return None
        return f"more than {self._memory_bytes / 1e9:.2g} GB of memory (--policy-memory)"

    def _carry_out(self, worker: Worker, late_s: float) -> None:
        if late_s >= 0.0:
            worker.kill()
        if late_s > _FORCE_S:
            worker.force()
