"""How much memory a process and its children have."""


def used_bytes(pid: int) -> int:
    """Return what a process and all below it hold of their own; 0 where that cannot be known."""
    total, pids = 0, [pid]
    while pids:
        each = pids.pop()
        try:
            with open(f"/proc/{each}/status", encoding="ascii", errors="replace") as file:
                for line in file:
                    if line.startswith(("RssAnon", "RssShmem")):
                        total += 1024 * int(line.split()[1])
            with open(f"/proc/{each}/task/{each}/children", encoding="ascii") as file:
                pids += map(int, file.read().split())
        except OSError:
            continue
    return total
