"""How long a policy may take and how much memory it may have, and what this machine can give."""

import os
from dataclasses import dataclass
from pathlib import Path

from ....base.errors import InputError, require_between

_SHARE = 0.8
"""Of the memory that is available when an engine starts: what all workers may have together."""
_FALLBACK_BYTES = 2**30
"""Where the system does not say what is available."""
_LEAST_BYTES = 2**26
"""Below this the simulator itself does not fit."""
_MOST_BYTES = 2**60
"""The system counts in 64 bits, and a worker holds something already."""
_START, _MEAN = 10.0, 1.0 / 60.0
_CGROUP = Path("/sys/fs/cgroup")
_UNITS = {"": 1, "b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "tb": 10**12} | {
    "kib": 2**10,
    "mib": 2**20,
    "gib": 2**30,
    "tib": 2**40,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What a policy may take, beyond which its process is killed and the policy fails.

    Attributes
    ----------
    timeout_s : float
        Wall time without a new frame: from the start of a run to its first frame, from frame to
        frame, and while it is scored.  A whole run may take ten times this, and one sixtieth of
        it more for each frame begun: ten minutes and a second a frame by default, so that a run
        as long as anybody's is finished, and one that is slow in every frame is not waited for.
    memory_bytes : int or None
        Memory beyond what the worker holds before it runs the policy, the simulator's own
        buffers and all child processes included.  None for 80 % of what is available when the
        engine starts, divided by the workers.
    """

    timeout_s: float = 60.0
    memory_bytes: int | None = None

    def __post_init__(self) -> None:
        if not 0.1 <= self.timeout_s <= 1e7:
            raise InputError(
                f"policy timeout: expected 0.1 to 1e7 seconds, got {self.timeout_s}; "
                "1e7 is as good as none"
            )
        if self.memory_bytes is not None:
            require_between(self.memory_bytes, _LEAST_BYTES, _MOST_BYTES, "policy memory in bytes")

    def run_s(self, frames: int) -> float:
        """Return the time that a run may have taken when so many frames are begun."""
        return self.timeout_s * (_START + _MEAN * max(frames, 0))

    def worker_bytes(self, workers: int) -> int:
        """Return what each of so many workers may have, as things stand now."""
        if self.memory_bytes is not None:
            return self.memory_bytes
        return max(int(_SHARE * available_bytes() / workers), _LEAST_BYTES)


DEFAULT_LIMITS = Limits()


def make_limits(timeout_s: float, memory: str | None) -> Limits:
    """Return limits as a command line has them; raises `InputError` if they are none."""
    memory_bytes = None if memory is None else parse_bytes(memory)
    return Limits(timeout_s=timeout_s, memory_bytes=memory_bytes)


def parse_bytes(text: str) -> int:
    """Return bytes written as ``2GB``, ``500 MiB`` or a plain number.

    Raises `InputError` if it is none of these.
    """
    number = text.strip().lower().rstrip("abcdefghijklmnopqrstuvwxyz ")
    unit = text.strip().lower()[len(number) :].strip()
    try:
        return int(float(number) * _UNITS[unit])
    except (ValueError, KeyError, OverflowError):
        raise InputError(f"expected bytes such as 2GB or 500MiB, got {text}") from None


def count_processors() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def available_bytes() -> int:
    """Return the memory that is available now, within the limit of a container if there is one."""
    found = [_FALLBACK_BYTES]
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        values = {name: int(rest.split()[0]) for name, rest in (line.split(":") for line in lines)}
        found = [1024 * values["MemAvailable"]]
        limit = (_CGROUP / "memory.max").read_text(encoding="ascii").strip()
        if limit != "max":
            used = int((_CGROUP / "memory.current").read_text(encoding="ascii"))
            found.append(max(int(limit) - used, 0))
    except (OSError, KeyError, ValueError):
        pass  # another system, or no container: what was found so far counts
    return min(found)
