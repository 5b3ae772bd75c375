"""What workers share with their engine: inputs that nobody can write, and the beat of a task.

Both are files without a name, so that nothing is left behind however a process ends.  On Linux they
are sealed: no write, no change of size, by whatever way, reaches the others who have them mapped.
"""

import mmap
import os
import pickle
import tempfile
import time
from collections.abc import Callable, Sequence
from typing import Any, Self

from ....base.user_code import pickle_for_worker
from .task import Inputs

_ALIGNMENT = 64
"""Of arrays in the file, in bytes: as numpy allocates them."""
_BEAT_BYTES = 4096


class SharedInputs:
    """The inputs of a study in one file: a pickle, and the arrays that it refers to.

    Attributes
    ----------
    fd : int
        Descriptor of the file.
    sizes : list of int
        Lengths of the parts in bytes, the pickle first.
    """

    def __init__(self, inputs: Inputs) -> None:
        buffers: list[pickle.PickleBuffer] = []
        data = pickle_for_worker(dict(inputs), buffers.append)
        parts = [memoryview(data), *(buffer.raw() for buffer in buffers)]
        padded = [(part, bytes(-len(part) % _ALIGNMENT)) for part in parts]
        self._write([len(part) for part in parts], [piece for pair in padded for piece in pair])

    @classmethod
    def of_content(cls, sizes: list[int], content: bytes | memoryview) -> Self:
        """Return the same inputs on another machine, from the content of their file."""
        made = cls.__new__(cls)
        made._write(sizes, [content])  # noqa: SLF001 - of this very class
        return made

    def _write(self, sizes: list[int], pieces: Sequence[bytes | memoryview]) -> None:
        self.sizes = sizes
        self.fd = _nameless_file("lodbench-inputs")
        with open(os.dup(self.fd), "wb") as file:  # noqa: PTH123 - a descriptor, no path
            for piece in pieces:
                file.write(piece)
        if hasattr(os, "memfd_create"):
            import fcntl

            seals = fcntl.F_SEAL_WRITE | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
            fcntl.fcntl(self.fd, fcntl.F_ADD_SEALS, seals)

    def content(self) -> mmap.mmap:
        """Return what the file holds, as a map that cannot be written."""
        return mmap.mmap(self.fd, 0, access=mmap.ACCESS_READ)

    def close(self) -> None:
        """Let go of the file; processes that have it mapped keep it."""
        os.close(self.fd)


def load_inputs(fd: int, sizes: list[int]) -> dict[str, Any]:
    """Return the inputs in a file, whose arrays are maps of it that cannot be written."""
    mapped = memoryview(mmap.mmap(fd, 0, access=mmap.ACCESS_READ))
    parts: list[memoryview] = []
    offset = 0
    for size in sizes:
        parts.append(mapped[offset : offset + size])
        offset += size + -size % _ALIGNMENT
    return pickle.loads(parts[0], buffers=parts[1:])  # noqa: S301 - from the parent process


class Heart:
    """Where a worker says which frame of which task it begins, and when.

    A map of one page, apart from those of other workers: what a policy writes there is about
    itself alone.

    Attributes
    ----------
    fd : int
        Descriptor of the file.
    """

    def __init__(self, fd: int | None = None) -> None:
        if fd is None:
            fd = _nameless_file("lodbench-beat")
            os.ftruncate(fd, _BEAT_BYTES)
            if hasattr(os, "memfd_create"):
                import fcntl

                seals = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
                fcntl.fcntl(fd, fcntl.F_ADD_SEALS, seals)
        self.fd = fd
        # Whole cells of 8 bytes, which are written and read at once on every machine of today.
        self._cells = memoryview(mmap.mmap(fd, _BEAT_BYTES)).cast("q")

    def begin(self, task: int) -> Callable[[int], None]:
        """Say that a task begins; return what says that a frame does.

        A process that the policy forked ends as soon as it comes back to the replay: it would go
        on with it beside the worker.
        """
        cells, now_ns, pid = self._cells, time.monotonic_ns, os.getpid
        own = pid()

        def beat(frame: int) -> None:
            if pid() != own:
                os._exit(0)
            cells[0], cells[1] = frame, now_ns()

        cells[0], cells[1], cells[2] = -1, now_ns(), task
        return beat

    def read(self, task: int) -> tuple[int | None, int]:
        """Return the frame that a task is in and when it began it, in ns of the monotonic clock.

        (None, 0) if it has not begun the task.
        """
        frame, time_ns, begun = self._cells[0], self._cells[1], self._cells[2]
        return (None if frame < 0 else frame, time_ns) if begun == task else (None, 0)

    def close(self) -> None:
        """Let go of the file."""
        self._cells.release()
        os.close(self.fd)


def _nameless_file(label: str) -> int:
    """Return the descriptor of an empty file in memory, or of a temporary one without a name."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create(label, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    fd, path = tempfile.mkstemp(prefix=label)
    os.unlink(path)
    return fd
