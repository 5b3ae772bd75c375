"""How much memory a process and its children have."""

from pathlib import Path

_PROCESSES = Path("/proc")


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
