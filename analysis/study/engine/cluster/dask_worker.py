"""What a Dask worker does for a study.

It runs no policy and unpickles nothing of a user: tasks pass through it closed, to a process of
their own as on a single machine.
"""

import pickle
import threading
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, cast

from .....base.errors import InputError
from .....policies.registry import register_policy
from ..limits import Limits, available_bytes
from ..local.local_engine import LocalEngine
from ..task import Beat, Inputs, Outcome, Task
from .sent_inputs import SentInputs
from .versions import Versions, describe_difference, versions_here

_SHARE = 0.8
"""Of a Dask worker's memory: what the processes beside its threads may have together."""
_LOOK_S = 0.1
_WANTED = ("executing", "long-running")
"""States of a task in a Dask worker whose result somebody waits for."""


@dataclass(frozen=True, slots=True)
class ClosedTask:
    """A task whose pickle is opened where it is carried out.

    Attributes
    ----------
    owner, result_type : of the task, here of each for itself and not of the class
    data : bytes
        Its pickle.
    registered : mapping of str to bytes
        Pickles of a user's policies, by name.
    """

    owner: str
    result_type: Any
    data: bytes
    registered: Mapping[str, bytes]

    def __call__(self, inputs: Inputs, beat: Beat) -> Any:
        """Carry out the task (see `Task`)."""
        for name, data in self.registered.items():
            register_policy(name, pickle.loads(data))  # noqa: S301 - from the client
        try:
            task: Task = pickle.loads(self.data)  # noqa: S301 - from the client
        except ImportError as error:
            raise InputError(
                f"policy {self.owner}: expected code that the cluster's machines have, got "
                f"{error}; install it there, or name the policy as file.py:Class"
            ) from error
        return task(inputs, beat)


@dataclass(frozen=True, slots=True)
class Batch:
    """What a Dask worker is asked for: tasks of one owner, by versions that are the client's."""

    owner: str
    tasks: tuple[ClosedTask, ...]
    stop: bool
    limits: Limits
    versions: Versions


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of a batch; with a refusal it was not carried out, or not to the end."""

    outcomes: list[Outcome] = field(default_factory=list[Outcome])
    refusal: InputError | None = None


def carry_out(sent: SentInputs, batch: Batch) -> Answer:
    """Carry out a batch in a process of this machine."""
    difference = describe_difference(batch.versions, versions_here())
    if difference:
        return Answer(refusal=InputError(mismatch(difference)))
    limits = batch.limits
    if limits.memory_bytes is None:
        limits = replace(limits, memory_bytes=_bytes_for_a_thread())
    answer = Answer()
    try:
        with sent.engine(batch.owner, limits) as engine, _while_wanted(engine):
            answer.outcomes.extend(engine.run(cast("Sequence[Task]", batch.tasks), stop=batch.stop))
    except InputError as error:
        return replace(answer, refusal=error)
    return answer


def mismatch(difference: str) -> str:
    """Return what to say of a worker that would not give the bytes that the client would."""
    return (
        f"--scheduler: expected workers with the same versions as here, got {difference}; "
        "install the same there, and restart the workers"
    )


@contextmanager
def _while_wanted(engine: LocalEngine) -> Generator[None]:
    """Interrupt the engine if nobody waits for the block's results any more.

    A Dask worker does not stop a thread whose task was cancelled, as when the client is gone.
    """
    from distributed import get_worker

    worker: Any = get_worker()
    key: Any = worker.get_current_task()
    done = threading.Event()

    def look() -> None:
        while not done.wait(_LOOK_S):
            task = worker.state.tasks.get(key)
            if task is None or task.state not in _WANTED:
                engine.interrupt()

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _bytes_for_a_thread() -> int:
    """Return the memory that each thread's process may have.

    The memory limit of a Dask worker is shared among its threads; without one, what is available.
    """
    from distributed import get_worker

    worker: Any = get_worker()
    limit: Any = worker.memory_manager.memory_limit
    bytes_ = available_bytes() if not limit else min(int(limit), available_bytes())
    return max(int(_SHARE * bytes_ / worker.state.nthreads), 2**26)
