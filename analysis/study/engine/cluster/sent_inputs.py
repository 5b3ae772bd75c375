"""The inputs of a study on their way through a cluster, and the engines that they are for."""

import pickle
import threading
import weakref
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Any

from ..limits import Limits
from ..local.local_engine import LocalEngine
from ..local.shared_file import SharedInputs


class SentInputs:
    """Inputs in a file, whose content alone travels: what holds this holds hardly any memory.

    The engines of a machine live as long as this does.  When the cluster lets go of the inputs,
    for the client has closed its connection or is gone, the worker processes end.
    """

    def __init__(self, shared: SharedInputs) -> None:
        self._shared = shared
        self._lock = threading.Lock()
        self._idle: list[tuple[str, LocalEngine]] = []
        weakref.finalize(self, _end, self._idle, shared)

    def __reduce__(self) -> tuple[Any, ...]:
        return _arrive, (self._shared.sizes, pickle.PickleBuffer(self._shared.content()))

    @contextmanager
    def engine(self, owner: str, limits: Limits) -> Generator[LocalEngine]:
        """Give the block an engine of one process to itself: the owner's, if there is an idle one.

        There are as many as there are blocks at a time, which is the threads of a Dask worker.
        """
        with self._lock:
            same = [item for item in self._idle if item[0] == owner]
            found = (same or self._idle)[:1]
            for item in found:
                self._idle.remove(item)
        engine = found[0][1] if found else LocalEngine(self._shared, 1, limits).__enter__()
        try:
            yield engine
        except BaseException:
            engine.__exit__()  # nobody knows what state it is in
            raise
        with self._lock:
            self._idle.append((owner, engine))


def _arrive(sizes: list[int], content: bytes | bytearray | memoryview) -> SentInputs:
    return SentInputs(SharedInputs.of_content(sizes, memoryview(content)))


def _end(idle: list[tuple[str, LocalEngine]], shared: SharedInputs) -> None:
    while idle:
        idle.pop()[1].__exit__()
    with suppress(OSError):
        shared.close()
