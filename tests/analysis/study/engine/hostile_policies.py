"""Policies that draw everything in full, until in one frame they do something to their process.

Here are those that end, raise, hang and grow; `hostile_neighbours.py` has what they do to others.
"""

import asyncio
import ctypes
import mmap
import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lodbench.policies.bounds.full import Full

FRAME = 40
SILENT = f"^frame {FRAME}: no frame for 3 s"
LARGE = f"^frame {FRAME}: more than 0.6 GB of memory"


@dataclass(frozen=True)
class Deed:
    """What a policy does in frame 40.

    Attributes
    ----------
    do : callable
        Is given the policy.
    reason : str or None
        What the failure has to say, a pattern; None where there is no harm, and so no failure.
    quick : bool
        Whether it is seen at once.
    options : tuple of str
        What the command line is given with it.
    """

    do: Callable[[Any], None]
    reason: str | None
    quick: bool
    options: tuple[str, ...]


DEEDS: dict[str, Deed] = {}
"""By name."""


def hostile(
    reason: str | None, *, quick: bool = False, options: str = ""
) -> Callable[[Callable[[Any], None]], Callable[[Any], None]]:
    """Return what keeps a function as a deed."""

    def keep(do: Callable[[Any], None]) -> Callable[[Any], None]:
        DEEDS[do.__name__] = Deed(do, reason, quick, tuple(options.split()))
        return do

    return keep


class Hostile(Full):
    """Does its deed in frame 40."""

    def __init__(self, deed: str) -> None:
        self.deed = deed

    def reset(self, scene: Any, budget_ms: float) -> None:
        """Keep the scene."""
        super().reset(scene, budget_ms)
        self.scene = scene

    def select(self, view: Any) -> Any:
        """Act once, then go on."""
        if view.frame == FRAME:
            DEEDS[self.deed].do(self)
        return super().select(view)


# Processes that end.


@hostile(f"^frame {FRAME}: process ended with status 0 before its result$", quick=True)
def exits(policy: Any) -> None:
    """End as if all were well."""
    os._exit(0)


@hostile(f"^frame {FRAME}: process ended with status 3 before its result$")
def fails(policy: Any) -> None:
    """End with a status of its own."""
    os._exit(3)


@hostile(f"^frame {FRAME}: process ended by SIGSEGV$", quick=True)
def crashes(policy: Any) -> None:
    """Read where nothing is."""
    ctypes.string_at(0)


@hostile(f"^frame {FRAME}: process ended by SIGABRT$")
def aborts(policy: Any) -> None:
    """Abort, as a C library does whose memory is damaged."""
    os.abort()


@hostile(f"^frame {FRAME}: process ended by SIGKILL$")
def kills_itself(policy: Any) -> None:
    """End as the system ends what takes too much."""
    os.kill(os.getpid(), signal.SIGKILL)


@hostile(f"^frame {FRAME}: its process was killed together with the one that minds it$")
def kills_its_parent(policy: Any) -> None:
    """Kill the process that minds it, on purpose."""
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(1000.0)


@hostile(f"^frame {FRAME}: its process was killed")
def kills_the_server(policy: Any) -> None:
    """Kill the process that forks workers, and then what minds it."""
    about = Path(f"/proc/{os.getppid()}/stat").read_text(encoding="ascii")
    os.kill(int(about.rpartition(")")[2].split()[1]), signal.SIGKILL)
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(1000.0)


@hostile(f"^frame {FRAME}: process ended by SIGTERM$")
def kills_its_group(policy: Any) -> None:
    """End all that it was started with, as a shell script does."""
    os.killpg(0, signal.SIGTERM)
    time.sleep(1000.0)


@hostile(f"^frame {FRAME}: process ended with status 0 before its result$")
def leaves_orphans(policy: Any) -> None:
    """End, and leave a process in a session of its own that holds all descriptors."""
    if os.fork() == 0:
        os.setsid()
        time.sleep(1000.0)
    os._exit(0)


@hostile(f"^frame {FRAME}: process ended by SIGALRM$")
def alarms(policy: Any) -> None:
    """Have the system signal it."""
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    time.sleep(1000.0)


# Exceptions of every kind.


@hostile(f"^frame {FRAME}: SystemExit: 0$")
def leaves(policy: Any) -> None:
    """Leave as a script does."""
    sys.exit(0)


@hostile(f"^frame {FRAME}: KeyboardInterrupt$", quick=True)
def interrupts(policy: Any) -> None:
    """Raise what Ctrl-C raises."""
    raise KeyboardInterrupt


@hostile(f"^frame {FRAME}: GeneratorExit$")
def closes_generators(policy: Any) -> None:
    """Raise what ends a generator, in whose loop the engine runs."""
    raise GeneratorExit


@hostile(f"^frame {FRAME}: CancelledError$")
def cancels(policy: Any) -> None:
    """Raise what cancels a coroutine."""
    raise asyncio.CancelledError


class BareError(BaseException):
    """No `Exception`."""


@hostile(f"^frame {FRAME}: BareError: mine$")
def raises_bare(policy: Any) -> None:
    """Raise what no `except Exception` catches."""
    raise BareError("mine")


class UnprintableError(BaseException):
    """Has no text."""

    def __str__(self) -> str:
        raise KeyboardInterrupt


@hostile(f"^frame {FRAME}: UnprintableError$", quick=True)
def raises_unprintable(policy: Any) -> None:
    """Raise what cannot be described."""
    raise UnprintableError


# Processes that hang or grow.


@hostile(SILENT, options="--policy-timeout 3")
def loops(policy: Any) -> None:
    """Never come back."""
    while True:
        pass


@hostile(SILENT, options="--policy-timeout 3")
def holds_the_lock(policy: Any) -> None:
    """Never come back from C, and let no other thread run."""
    ctypes.PyDLL(None).sleep(1000)


@hostile(SILENT, options="--policy-timeout 3")
def ignores_signals(policy: Any) -> None:
    """Sleep, and hear no signal that can be ignored."""
    signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    while True:
        time.sleep(1000.0)


@hostile(SILENT, options="--policy-timeout 3")
def stops(policy: Any) -> None:
    """Stop its process."""
    os.kill(os.getpid(), signal.SIGSTOP)


@hostile(SILENT, options="--policy-timeout 3")
def stops_its_parent(policy: Any) -> None:
    """Stop the process that would kill it."""
    os.kill(os.getppid(), signal.SIGSTOP)
    time.sleep(1000.0)


@hostile(f"^frame {FRAME}: MemoryError", quick=True, options="--policy-memory 600MB")
def wants_much(policy: Any) -> None:
    """Ask for 20 GB at once."""
    policy.much = np.ones(20 * 2**27)


@hostile(f"^frame {FRAME}: MemoryError", options="--policy-memory 600MB")
def grows(policy: Any) -> None:
    """Take memory piece by piece."""
    much: list[Any] = []
    while True:
        much.append(np.ones(2**20))


@hostile(LARGE, options="--policy-memory 600MB")
def grows_shared(policy: Any) -> None:
    """Take memory that is not counted as its own."""
    with mmap.mmap(-1, 20 * 2**30) as much:
        for page in range(0, len(much), mmap.PAGESIZE):
            much[page] = 1


@hostile(LARGE, options="--policy-memory 600MB")
def grows_in_children(policy: Any) -> None:
    """Have its children take memory."""
    for _ in range(4):
        if os.fork() == 0:
            much = np.ones(2**25)
            time.sleep(1000.0 + float(much[0]))
    time.sleep(1000.0)


@hostile(f"^frame {FRAME}: process ended by SIGSEGV$")
def recurses(policy: Any) -> None:
    """Call itself until the stack of C ends."""

    class Deep:
        def __getattr__(self, name: str) -> Any:
            return getattr(self, f"{name}x")

    sys.setrecursionlimit(10**9)
    _ = Deep().missing
