"""What a worker process does: tasks of one owner, one after the other, until it is killed."""

import importlib
import os
import pickle
import resource
import signal
import socket
import sys
import time
from dataclasses import dataclass
from typing import Any, NoReturn

from ....base.errors import InputError, PolicyError
from ....policies.registry import REGISTERED, register_policy
from .messages import Reply, encode_reply, receive_task
from .shared_file import Heart, load_inputs
from .task import Beat, Inputs, NotApplicableError, Task

THREADS = {
    f"{library}_NUM_THREADS": "1"
    for library in ("OPENBLAS", "OMP", "MKL", "BLIS", "NUMEXPR", "VECLIB_MAXIMUM")
}
"""Workers are as many as processors, and sums of one thread are the same on every machine."""

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


def here(sizes: list[int], registered: dict[str, bytes], memory_bytes: int) -> Setup:
    """Return the surroundings of this process."""
    try:
        folder = os.getcwd()
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


def work(channel: socket.socket, inputs_fd: int, heart_fd: int) -> NoReturn:
    """Carry out what comes through the channel until it is closed; never returns."""
    identity = os.fstat(channel.fileno()).st_ino
    inputs = _prepare(channel, inputs_fd)
    heart = Heart(heart_fd)
    own = os.getpid()
    while True:
        message = receive_task(channel)
        if message is None:
            os._exit(0)
        index, data = message
        parts = _carry_out(index, data, inputs, heart.begin(index))
        # A child that the policy forked may come back here, and descriptors may be another's now.
        if os.getpid() != own or os.fstat(channel.fileno()).st_ino != identity:
            os._exit(0)
        for part in parts:
            channel.sendall(part)


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
    _limit(setup.memory_bytes)
    return inputs


def _limit(memory_bytes: int) -> None:
    """Let allocations beyond so many bytes fail, and leave no picture of a process that crashes."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        with open("/proc/self/status", encoding="ascii") as file:
            held = next(int(line.split()[1]) for line in file if line.startswith("VmData"))
        with open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write("1000")  # where memory runs out, it is a policy that ends
    except (OSError, StopIteration):
        return  # another system, which does not enforce the limit either
    most = 1024 * held + memory_bytes
    resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def _carry_out(index: int, data: memoryview, inputs: Inputs, beat: Beat) -> list[Any]:
    """Carry out one task and return the message of how it ended."""
    start = time.monotonic()
    began = [-1]

    def count(frame: int) -> None:
        began[0] = frame
        beat(frame)

    def reply(kind: str, **more: Any) -> Reply:
        return Reply(
            index,
            kind,
            _NOTHING,
            took_s=time.monotonic() - start,
            peak_bytes=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _RSS_UNIT,
            **more,
        )

    try:
        try:
            task: Task = pickle.loads(data)  # noqa: S301 - from the parent process
            value = task(inputs, count)
            return encode_reply(reply("result"), value)
        except BaseException as error:  # whatever a policy raises, it is its own failure
            sys.setrecursionlimit(_RECURSION)  # a policy may have left next to nothing
            frame = None if began[0] < 0 else began[0]
            return encode_reply(reply(**_end_of(error, frame)))
    finally:
        # What it had pending must not hit the message or the next task's beginning.
        signal.alarm(0)


def _end_of(error: BaseException, frame: int | None) -> dict[str, Any]:
    if isinstance(error, PolicyError):
        return {"kind": "failed", "reason": str(error.reason), "frame": error.frame}
    if isinstance(error, NotApplicableError):
        return {"kind": "not-applicable", "reason": describe(error, named=False)}
    if isinstance(error, InputError):
        about = {"path": error.path, "line": error.line}
        return {"kind": "input", "reason": error.message, **about}
    return {"kind": "failed", "reason": describe(error), "frame": frame}


def describe(error: BaseException, *, named: bool = True) -> str:
    """Return an exception in one line, also one whose text cannot be had."""
    try:
        text = " ".join(str(error).split())
    except BaseException:
        text = ""
    if not named:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


_NOTHING: Any = encode_reply  # replaced when it is encoded
_RSS_UNIT = 1 if sys.platform == "darwin" else 1024
