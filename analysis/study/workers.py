"""Jobs on this process or on several, with the same results in the same order."""

import mmap
import os
import pickle
import signal
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

from ...base.errors import InputError
from ...base.user_code import pickle_for_worker
from ...policies.registry import REGISTERED, register_policy
from .score import Job, Scored, World, score

RunJobs: TypeAlias = Callable[[Sequence[Job]], Iterable[Scored]]
"""Yields the score of each job as it is finished, in the order of the jobs."""

_ALIGNMENT = 64
"""Of arrays in the shared file, in bytes: as numpy allocates them."""

_world: World | None = None
"""The world of a worker process."""


@contextmanager
def started(world: World, workers: int, jobs: int) -> Generator[RunJobs]:
    """Start workers for so many jobs, and yield what runs them; with one worker it runs them here.

    With 0 there are as many workers as processors.

    Running jobs raises `InputError` if another process cannot get at the class of a policy, such
    as one that was typed into a notebook, or ends before its work is done.
    """
    workers = min(workers or os.cpu_count() or 1, jobs)
    if workers <= 1:
        yield lambda jobs: (score(world, job) for job in jobs)
        return
    with (
        TemporaryDirectory(prefix="lodbench-") as folder,
        ProcessPoolExecutor(
            workers,
            mp_context=get_context("spawn"),
            initializer=_start,
            initargs=_pack(world, Path(folder) / "world"),
        ) as pool,
    ):
        try:
            yield lambda jobs: pool.map(_score_here, map(_message, jobs))
        except BrokenProcessPool as error:
            raise InputError(
                "workers: expected processes that finish their work, got one that ended; a script "
                'calls this under `if __name__ == "__main__":`, and workers=1 does without others'
            ) from error
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _pack(world: World, path: Path) -> tuple[Path, list[int]]:
    """Write the world to a file, and return it with the sizes of its parts, the pickle first.

    Workers map the file, so that they share its arrays, and cannot write to them.  What a process
    is started with goes through a pipe, and a large world would block it where the process dies.
    """
    buffers: list[pickle.PickleBuffer] = []
    data = pickle.dumps(world, protocol=5, buffer_callback=buffers.append)
    parts = [memoryview(data), *(buffer.raw() for buffer in buffers)]
    with path.open("wb") as file:
        for part in parts:
            file.write(part)
            file.write(bytes(-len(part) % _ALIGNMENT))
    return path, [len(part) for part in parts]


def _start(path: Path, sizes: list[int]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends a worker without a traceback
    global _world  # noqa: PLW0603 - a worker process has one world for all its jobs
    with path.open("rb") as file:
        mapped = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    parts: list[memoryview] = []
    offset = 0
    for size in sizes:
        parts.append(mapped[offset : offset + size])
        offset += size + -size % _ALIGNMENT
    _world = pickle.loads(parts[0], buffers=parts[1:])  # noqa: S301 - from the parent process


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
