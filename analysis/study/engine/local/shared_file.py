"""What workers share with their engine: inputs that nobody can write, and the beat of a task.

Both are files without a name, so that nothing is left behind however a process ends.  On Linux they
are sealed: no write, no change of size, by whatever way, reaches the others who have them mapped.
"""

import mmap
import os
import pickle
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, Self

from .....base.portable_pickle import portable_pickle
from ..task import Inputs

_ALIGNMENT = 64
"""Of arrays in the file, in bytes: as numpy allocates them."""
_BEAT_BYTES = 4096
_F_SEAL_FUTURE_WRITE = 0x10  # of Linux 5.1 and later, which fcntl does not name


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
        data = portable_pickle(dict(inputs), buffers.append)
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
            file.writelines(pieces)
        if hasattr(os, "memfd_create"):
            import fcntl

            seals = fcntl.F_SEAL_WRITE | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
            fcntl.fcntl(self.fd, fcntl.F_ADD_SEALS, seals)

    def content(self) -> mmap.mmap:
        """Return what the file holds, as a map that cannot be written."""
        return _map(self.fd)

    def close(self) -> None:
        """Let go of the file; processes that have it mapped keep it."""
        os.close(self.fd)


def load_inputs(fd: int, sizes: list[int]) -> dict[str, Any]:
    """Return the inputs in a file, whose arrays are maps of it that cannot be written."""
    mapped = memoryview(_map(fd))
    parts: list[memoryview] = []
    offset = 0
    for size in sizes:
        parts.append(mapped[offset : offset + size])
        offset += size + -size % _ALIGNMENT
    return pickle.loads(parts[0], buffers=parts[1:])  # noqa: S301 - from the parent process


def _map(fd: int) -> mmap.mmap:
    if not hasattr(mmap, "MAP_PRIVATE"):
        return mmap.mmap(fd, 0, access=mmap.ACCESS_READ)
    # Private, though nobody writes: before Linux 6.7 a sealed file cannot be mapped shared at all.
    return mmap.mmap(fd, 0, flags=mmap.MAP_PRIVATE, prot=mmap.PROT_READ)


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

                fcntl.fcntl(fd, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW)
        self.fd = fd
        # Whole cells of 8 bytes, which are written and read at once on every machine of today.
        self._cells = memoryview(mmap.mmap(fd, _BEAT_BYTES)).cast("q")

    def seal(self) -> None:
        """Keep what is written to any descriptor out of the file, where the system can."""
        if not hasattr(os, "memfd_create"):
            return
        import fcntl

        with suppress(OSError):
            fcntl.fcntl(self.fd, fcntl.F_ADD_SEALS, _F_SEAL_FUTURE_WRITE | fcntl.F_SEAL_SEAL)

    def begin(self, task: int) -> None:
        """Say that a task begins."""
        self._cells[0], self._cells[1], self._cells[2] = -1, time.monotonic_ns(), task

    def beat(self, frame: int) -> None:
        """Say that a frame of it begins."""
        self._cells[0], self._cells[1] = frame, time.monotonic_ns()

    def read(self, task: int) -> tuple[int | None, int]:
        """Return the frame that a task is in and when it began it, in ns of the monotonic clock.

        (None, 0) if it has not begun the task.
        """
        frame, time_ns, begun = self._cells[0], self._cells[1], self._cells[2]
        return (frame if 0 <= frame < 2**48 else None, time_ns) if begun == task else (None, 0)

    def close(self) -> None:
        """Let go of the file."""
        self._cells.release()
        os.close(self.fd)


def _nameless_file(label: str) -> int:
    """Return the descriptor of an empty file in memory, or of a temporary one without a name."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create(label, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    with tempfile.TemporaryFile(prefix=label) as file:
        return os.dup(file.fileno())
