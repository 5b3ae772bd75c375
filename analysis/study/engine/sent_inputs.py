"""The inputs of a study on their way through a cluster, and the worker processes they are for."""

import pickle
import threading
import weakref
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Any

from .limits import Limits
from .local_engine import LocalEngine
from .shared_file import SharedInputs

_HERE: "weakref.WeakValueDictionary[str, SentInputs]" = weakref.WeakValueDictionary()
"""What has arrived in this process, by study."""


class SentInputs:
    """Inputs in a file, whose content alone travels: what holds this holds hardly any memory.

    The engines of the machine live as long as this does: when the cluster lets go of the inputs,
    for the client has closed its connection or is gone, the worker processes end.

    Parameters
    ----------
    study
        Which call of which client this is for.
    """

    def __init__(self, study: str, shared: SharedInputs) -> None:
        self.study, self.shared = study, shared
        self._lock = threading.Lock()
        self._idle: list[tuple[str, LocalEngine]] = []
        self._busy: set[LocalEngine] = set()
        self.abandoned = False
        weakref.finalize(self, _end, self._idle, shared)
        _HERE[study] = self

    def __reduce__(self) -> tuple[Any, ...]:
        content = pickle.PickleBuffer(self.shared.content())
        return _arrive, (self.study, self.shared.sizes, content)

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
            engine = found[0][1] if found else LocalEngine(self.shared, 1, limits)
            self._busy.add(engine)
        try:
            yield engine
        finally:
            with self._lock:
                self._busy.discard(engine)
                if self.abandoned:
                    engine.__exit__()
                else:
                    self._idle.append((owner, engine))

    def abandon(self) -> None:
        """End all engines: nobody waits for what they do."""
        with self._lock:
            self.abandoned = True
            for engine in self._busy:
                engine.interrupt()
            _end_engines(self._idle)


def abandon(study: str) -> None:
    """End what runs here for a study, if anything does."""
    sent = _HERE.get(study)
    if sent is not None:
        sent.abandon()


def _arrive(study: str, sizes: list[int], content: bytes | bytearray | memoryview) -> SentInputs:
    return SentInputs(study, SharedInputs.of_content(sizes, memoryview(content)))


def _end(idle: list[tuple[str, LocalEngine]], shared: SharedInputs) -> None:
    _end_engines(idle)
    with suppress(OSError):
        shared.close()


def _end_engines(idle: list[tuple[str, LocalEngine]]) -> None:
    while idle:
        idle.pop()[1].__exit__()
