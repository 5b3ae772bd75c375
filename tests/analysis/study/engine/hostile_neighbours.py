"""Hostile policies that reach for what a process shares with others, or has but once."""

import _thread
import atexit
import contextlib
import ctypes
import faulthandler
import gc
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lodbench.analysis.study import score
from lodbench.base.user_code import load_file

_base: Any = load_file(Path(__file__).with_name("hostile_policies.py"), "policies")
DEEDS, FRAME, hostile = _base.DEEDS, _base.FRAME, _base.hostile
DESCRIPTORS = range(3, 200)


class Hostile(_base.Hostile):
    """Does its deed in frame 40."""


# What the engine and the worker speak through.


@hostile(f"^frame {FRAME}: its process closed what it answers through$", quick=True)
def closes_all(policy: Any) -> None:
    """Close every descriptor."""
    os.closerange(0, 1000)


@hostile(f"^frame {FRAME}: its process closed what it answers through$")
def replaces_all(policy: Any) -> None:
    """Close every descriptor, and have files of its own under their numbers."""
    os.closerange(0, 1000)
    for _ in DESCRIPTORS:
        os.open(os.devnull, os.O_RDWR)


@hostile("its process sent what is no result$", quick=True)
def writes_everywhere(policy: Any) -> None:
    """Write to every descriptor that it finds."""
    for fd in DESCRIPTORS:
        with contextlib.suppress(OSError):
            os.write(fd, b"nonsense" * 100)


@hostile("its process sent what is no result$")
def announces_much(policy: Any) -> None:
    """Announce a result of a petabyte."""
    for fd in DESCRIPTORS:
        with contextlib.suppress(OSError):
            os.write(fd, struct.pack("<4sIQ", b"LODB", 10, 2**50))


@hostile("its process sent what is no result$")
def results_in_nonsense(policy: Any) -> None:
    """Have the code that scores it return something else."""

    def find_nothing(_: Any) -> str:
        return "nonsense"

    score.__dict__["find_steps"] = find_nothing


@hostile("its process sent what is no result$")
def results_in_little(policy: Any) -> None:
    """Have the code that scores it know no metrics."""
    score.__dict__["METRICS"] = ()


@hostile("TypeError: expected numbers, text and arrays, got Rogue$")
def results_in_code(policy: Any) -> None:
    """Have its result be an object that runs code where it is unpickled."""

    class Rogue:
        def __reduce__(self) -> Any:
            return os.abort, ()

    def make_rogue(*_: Any, **__: Any) -> Any:
        return Rogue()

    score.__dict__["Scored"] = make_rogue


# What others share with it.


@hostile(f"^frame {FRAME}: ValueError: cannot set WRITEABLE flag")
def sets_flags(policy: Any) -> None:
    """Make an array of the scene writable."""
    policy.scene.position_m.flags.writeable = True


@hostile(f"^frame {FRAME}: process ended by SIGSEGV$")
def writes_by_address(policy: Any) -> None:
    """Write to an array of the scene as C does."""
    ctypes.memset(policy.scene.position_m.ctypes.data, 0, 64)


@hostile(f"^frame {FRAME}: ValueError: nothing gave way$", quick=True)
def writes_by_file(policy: Any) -> None:
    """Open what it has mapped once more, overwrite it and cut it short."""
    for link in Path("/proc/self/fd").iterdir():
        for flags in (os.O_RDWR, os.O_RDWR | os.O_TRUNC):
            with contextlib.suppress(OSError):
                if "memfd" in str(link.readlink()):
                    again = os.open(link, flags)
                    os.ftruncate(again, 0)
    raise ValueError("nothing gave way")


# What a process has but once.


@hostile("ZeroDivisionError: patched$", quick=True)
def patches_numpy(policy: Any) -> None:
    """Replace functions that everybody uses."""

    def broken(*_: Any, **__: Any) -> Any:
        raise ZeroDivisionError("patched")

    for name in ("quantile", "mean", "asarray", "sort", "cumsum", "percentile"):
        setattr(np, name, broken)


@hostile(f"^frame {FRAME}: FloatingPointError")
def raises_floats(policy: Any) -> None:
    """Have numpy raise what it would warn of."""
    np.seterr(all="raise")
    _ = np.zeros(1) / np.zeros(1)


@hostile("RuntimeError: traced$")
def traces(policy: Any) -> None:
    """Trace every call, and raise."""

    def trace(*_: Any) -> Any:
        raise RuntimeError("traced")

    sys.settrace(trace)


@hostile(None)
def limits_recursion(policy: Any) -> None:
    """Leave next to no stack, which is enough or is not, but harm nobody else."""
    sys.setrecursionlimit(200)


@hostile(None, quick=True)
def rearranges(policy: Any) -> None:
    """Change what else a process has but once."""
    gc.disable()
    faulthandler.enable()
    os.chdir("/")
    os.umask(0o777)
    os.environ.clear()
    atexit.register(time.sleep, 1000.0)


@hostile(None, quick=True)
def prints(policy: Any) -> None:
    """Print in every way there is."""
    print("to stdout")
    print("to stderr", file=sys.stderr)
    os.write(1, b'{"schema": "mine"}\n' * 100_000)
    os.write(2, b"by number\n")
    subprocess.run(["echo", "from a program"], check=True)


@hostile(None)
def closes_output(policy: Any) -> None:
    """Close what it would print to."""
    sys.stdout.close()
    sys.stderr.close()
    with suppress(OSError):  # closed by a run before, in the same process
        os.close(0)


@hostile(None)
def goes_on(policy: Any) -> None:
    """Leave threads behind that go on."""

    def work() -> None:
        while True:
            time.sleep(0.001)

    for _ in range(3):
        threading.Thread(target=work).start()


@hostile(None, quick=True)
def forks(policy: Any) -> None:
    """Fork, and both processes come back from it."""
    os.fork()


@hostile(None)
def forks_in_every_frame(policy: Any) -> None:
    """Fork from now on in every frame, and all processes come back from it."""
    select = policy.select

    def fork_and_select(view: Any) -> Any:
        os.fork()
        return select(view)

    policy.select = fork_and_select


@hostile(f"^frame {FRAME}: KeyboardInterrupt$")
def interrupts_itself(policy: Any) -> None:
    """Have another thread interrupt the replay, as Ctrl-C does."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.01, _thread.interrupt_main).start()
    for _ in range(10_000):
        time.sleep(0.001)
