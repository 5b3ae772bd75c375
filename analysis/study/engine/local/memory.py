"""How much memory a process and its children have, and may have."""

import os
import sys
from pathlib import Path

_PROCESSES = Path("/proc")
_RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # of ru_maxrss, in bytes


def used_bytes(pid: int) -> int:
    """Return what a process and all below it hold of their own; 0 where that cannot be known."""
    total, pids = 0, [pid]
    while pids:
        each = pids.pop()
        root = _PROCESSES / str(each)
        try:
            with (root / "status").open(encoding="ascii", errors="replace") as file:
                for line in file:
                    if line.startswith(("RssAnon", "RssShmem")):
                        total += 1024 * int(line.split()[1])
            children = (root / "task" / str(each) / "children").read_text(encoding="ascii")
            pids += map(int, children.split())
        except OSError:
            continue
    return total


def peak_bytes() -> int:
    """Return the most memory that this process has had; 0 where that cannot be known."""
    if os.name != "posix":
        return 0
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _RSS_UNIT


def limit_memory(memory_bytes: int) -> None:
    """Let allocations beyond so many bytes more fail, and leave no picture of a crash.

    Only Linux enforces it.
    """
    if os.name != "posix":
        return
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    own = _PROCESSES / "self"
    try:
        lines = (own / "status").read_text(encoding="ascii").splitlines()
        held = next(int(line.split()[1]) for line in lines if line.startswith("VmData"))
        # Where memory runs out, it is a policy that ends.
        (own / "oom_score_adj").write_text("1000", encoding="ascii")
    except (OSError, StopIteration):
        return
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)  # whoever started us may have limited us
    most = 1024 * held + memory_bytes
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, most))
