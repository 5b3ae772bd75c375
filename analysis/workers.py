"""Jobs on this process or on several, with the same results in the same order."""

import pickle
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from .score import Job, Scored, World, score

__all__ = ["Tick", "run_jobs"]

Tick = Callable[[], None]
"""Called when a job is finished."""

_world: World | None = None
"""The world of a worker process."""


def run_jobs(world: World, jobs: Sequence[Job], workers: int, tick: Tick) -> list[Scored]:
    """Return the score of each job, in their order."""
    count = min(workers, len(jobs))
    scored: list[Scored] = []
    if count <= 1:
        for job in jobs:
            scored.append(score(world, job))
            tick()
        return scored
    with ProcessPoolExecutor(
        count, mp_context=get_context("spawn"), initializer=_start, initargs=_pack(world)
    ) as pool:
        try:
            for result in pool.map(_score_here, jobs):
                scored.append(result)
                tick()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return scored


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
