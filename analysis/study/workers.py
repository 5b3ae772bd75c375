"""Jobs on this process or on several, with the same results in the same order."""

import pickle
import signal
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any, TypeAlias

from ...base.errors import InputError
from ...base.user_code import pickle_for_worker
from ...policies.registry import REGISTERED, register_policy
from .score import Job, Scored, World, score

RunJobs: TypeAlias = Callable[[Sequence[Job]], Iterable[Scored]]
"""Yields the score of each job as it is finished, in the order of the jobs."""

_world: World | None = None
"""The world of a worker process."""


@contextmanager
def started(world: World, workers: int) -> Generator[RunJobs]:
    """Start workers, and yield what runs jobs on them; with one worker it runs them here.

    Running jobs raises `InputError` if another process cannot get at the class of a policy, such
    as one that was typed into a notebook.
    """
    if workers <= 1:
        yield lambda jobs: (score(world, job) for job in jobs)
        return
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_start, initargs=_pack(world)
    ) as pool:
        try:
            yield lambda jobs: pool.map(_score_here, map(_message, jobs))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _pack(world: World) -> tuple[bytes, list[bytes]]:
    """Pickle the world with its arrays apart as bytes, so that they arrive read-only."""
    buffers: list[pickle.PickleBuffer] = []
    data = pickle.dumps(world, protocol=5, buffer_callback=buffers.append)
    return data, [bytes(buffer.raw()) for buffer in buffers]


def _start(data: bytes, buffers: list[bytes]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends a worker without a traceback
    global _world  # noqa: PLW0603 - a worker process has one world for all its jobs
    _world = pickle.loads(data, buffers=buffers)  # noqa: S301 - from the parent process


def _message(job: Job) -> tuple[str, bytes]:
    """Return a job and the names that its policy may look up, for another process."""
    label = job.policy.label
    try:
        return label, pickle_for_worker((REGISTERED.users, job))
    except Exception as error:  # whatever the state of a user's object raises
        raise _unreachable(label, error) from error


def _score_here(message: tuple[str, bytes]) -> Scored:
    assert _world is not None, "a worker is started with a world"
    label, data = message
    own: dict[str, type[Any]]
    job: Job
    try:
        own, job = pickle.loads(data)  # noqa: S301 - from the parent process
    except InputError:  # a user's file that has gone or changed says so itself
        raise
    except Exception as error:
        raise _unreachable(label, error) from error
    for name, cls in own.items():
        register_policy(name, cls)
    return score(_world, job)


def _unreachable(label: str, error: Exception) -> InputError:
    return InputError(
        f"policy {label}: expected a policy that other processes can load, got "
        f"{type(error).__name__}: {error}; put its class into a file, or give workers=1"
    )
