"""Jobs on this process or on several, with the same results in the same order."""

import pickle
import signal
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeAlias

from .score import Job, Scored, World, score

RunJobs: TypeAlias = Callable[[Sequence[Job]], Iterable[Scored]]
"""Yields the score of each job as it is finished, in the order of the jobs."""

_world: World | None = None
"""The world of a worker process."""


@contextmanager
def started(world: World, workers: int) -> Generator[RunJobs]:
    """Start workers, and yield what runs jobs on them; with one worker it runs them here."""
    if workers <= 1:
        yield lambda jobs: (score(world, job) for job in jobs)
        return
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_start, initargs=_pack(world)
    ) as pool:
        try:
            yield lambda jobs: pool.map(_score_here, jobs)
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


def _score_here(job: Job) -> Scored:
    assert _world is not None, "a worker is started with a world"
    return score(_world, job)
