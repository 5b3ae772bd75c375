"""What a worker process does: tasks of one owner, one after the other, until it is killed."""

import importlib
import os
import pickle
import socket
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from .....base.errors import InputError, PolicyError
from .....base.foreign_text import describe_error
from .....policies.registry import register_policy
from ..task import Inputs, NotApplicableError, Task
from .memory import limit_memory, peak_bytes
from .messages import Reply, encode_reply, receive_task
from .shared_file import Heart, load_inputs

THREADS = {
    f"{library}_NUM_THREADS": "1"
    for library in ("OPENBLAS", "OMP", "MKL", "BLIS", "NUMEXPR", "VECLIB_MAXIMUM")
}
"""Workers are as many as processors, and sums of one thread are the same on every machine."""

CLOSED = 113
"""Exit status of a worker that finds its channel closed."""

_RECURSION = sys.getrecursionlimit()


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What a worker starts with: the caller's surroundings, and where the inputs are.

    Attributes
    ----------
    folder, environment, arguments, path : of the caller's process
    sizes : parts of the file of inputs
    registered : pickles of a user's policies, by name
    memory_bytes : what the worker may have beyond what it has after this
    """

    folder: str
    environment: dict[str, str]
    arguments: list[str]
    path: list[str]
    sizes: list[int]
    registered: dict[str, bytes]
    memory_bytes: int


def surroundings() -> dict[str, str]:
    """Return the environment that a process of workers is started with."""
    hashes = {"PYTHONHASHSEED": "0"}  # sets of text are walked in the same order every time
    return hashes | dict(os.environ) | THREADS


def here(sizes: list[int], registered: dict[str, bytes], memory_bytes: int) -> Setup:
    """Return the surroundings of this process."""
    try:
        folder = str(Path.cwd())
    except OSError:  # it has been removed
        folder = "/"
    return Setup(
        folder=folder,
        environment=dict(os.environ) | THREADS,
        arguments=list(sys.argv),
        path=[str(entry) for entry in sys.path],
        sizes=sizes,
        registered=registered,
        memory_bytes=memory_bytes,
    )


class _Session:
    """What a worker has from its engine, and is to find as it was after each frame."""

    def __init__(self, channel: socket.socket, heart: Heart, inputs: Inputs) -> None:
        self._channel, self._heart, self._inputs = channel, heart, inputs
        self._pid, self._fd = os.getpid(), channel.fileno()
        self._identity = _identity(self._fd)
        self._frame = -1

    def serve(self) -> NoReturn:
        """Carry out tasks until the channel is closed."""
        while True:
            message = receive_task(self._channel)
            if message is None:
                os._exit(0)
            index, data = message
            self._frame = -1
            self._heart.begin(index)
            parts = self._carry_out(index, data)
            self._require_own()
            for part in parts:
                self._channel.sendall(part)

    def beat(self, frame: int) -> None:
        """Say that a frame begins (see `Beat`)."""
        self._require_own()
        self._frame = frame
        self._heart.beat(frame)

    def _require_own(self) -> None:
        """End a process that the policy forked and that comes back, or whose channel is closed.

        A descriptor of the channel's number may be that of a file of the policy by now.
        """
        if os.getpid() != self._pid:
            os._exit(0)
        try:
            if _identity(self._fd) == self._identity:
                return
        except OSError:
            pass
        os._exit(CLOSED)

    def _carry_out(self, index: int, data: memoryview) -> list[Any]:
        """Carry out one task and return the message of how it ended."""
        start = time.monotonic()
        value: object = None
        try:
            value = self._load(data)(self._inputs, self.beat)
            reply = Reply(index, "result")
        except BaseException as error:  # noqa: BLE001 - it is the policy's own failure
            sys.setrecursionlimit(_RECURSION)  # a policy may have left next to nothing
            reply = _reply_to(index, error, self._frame)
        reply.took_s = time.monotonic() - start
        reply.peak_bytes = peak_bytes()
        if reply.kind == "result":
            reply.frame = frame_of(self._frame)
        try:
            return encode_reply(reply, value)
        except BaseException as error:  # noqa: BLE001 - as above
            return encode_reply(_reply_to(index, error, self._frame))

    def _load(self, data: memoryview) -> Task:
        try:
            return pickle.loads(data)  # noqa: S301 - from the parent process
        except InputError:  # a user's file that has gone or changed
            raise
        except BaseException as error:  # whatever the state of a user's object raises
            raise PolicyError(
                "", None, f"its class does not load: {describe_error(error)}"
            ) from error


def _identity(fd: int) -> int:
    """Return what tells a descriptor's file from others; sockets of Windows have no such thing."""
    return os.fstat(fd).st_ino if os.name == "posix" else 0


def frame_of(number: int) -> int | None:
    """Return a frame, None before the first."""
    return None if number < 0 else number


def work(channel: socket.socket, inputs_fd: int, heart_fd: int) -> NoReturn:
    """Carry out what comes through the channel until it is closed; never returns."""
    inputs = _prepare(channel, inputs_fd)
    heart = Heart(heart_fd)
    heart.seal()
    _Session(channel, heart, inputs).serve()


def _prepare(channel: socket.socket, inputs_fd: int) -> dict[str, Any]:
    """Take on the caller's surroundings; return the inputs."""
    message = receive_task(channel)
    if message is None:
        os._exit(0)
    setup: Setup = pickle.loads(message[1])  # noqa: S301 - from the parent process
    os.environ.clear()
    os.environ.update(setup.environment)
    sys.argv[:], sys.path[:] = setup.arguments, setup.path
    importlib.invalidate_caches()
    try:
        os.chdir(setup.folder)
    except OSError:
        os.chdir("/")
    inputs = load_inputs(inputs_fd, setup.sizes)
    os.close(inputs_fd)
    for name, data in setup.registered.items():
        try:
            register_policy(name, pickle.loads(data))  # noqa: S301 - from the parent process
        except Exception:  # noqa: BLE001, S112 - a name that is looked up is missed by name
            continue
    limit_memory(setup.memory_bytes)
    return inputs


def _reply_to(index: int, error: BaseException, frame: int) -> Reply:
    """Return what is said of a task that raised."""
    if isinstance(error, PolicyError):
        return Reply(index, "failed", reason=str(error.reason), frame=error.frame)
    if isinstance(error, NotApplicableError):
        return Reply(index, "not-applicable", reason=str(error))
    if isinstance(error, InputError):
        reason, path, line = error.message, error.path, error.line
        return Reply(index, "input", reason=reason, path=path, line=line)
    return Reply(index, "failed", reason=describe_error(error), frame=frame_of(frame))
