"""Counts, times and sizes in words, in the unit in which one thinks of them."""

_UNITS = ("kB", "MB", "GB", "TB")


def count_text(count: int, noun: str) -> str:
    """Return a number of things such as ``1 run`` or ``2,000 runs``."""
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def duration_text(seconds: float) -> str:
    """Return a time such as ``12 s``, ``5 min``, ``30 h`` or ``4 days``."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    if minutes < 100:
        return f"{minutes} min"
    hours = minutes / 60.0
    return f"{hours:.0f} h" if hours < 72.0 else f"{hours / 24.0:.0f} days"


def bytes_text(count: float) -> str:
    """Return a size such as ``1.2 MB``, in powers of 1,000."""
    if count < 1e3:
        return f"{count:.0f} bytes"
    power = 1
    while count >= 999.5 * 1e3**power and power < len(_UNITS):
        power += 1
    count, unit = count / 1e3**power, _UNITS[power - 1]
    return f"{count:.2g} {unit}" if count < 10.0 else f"{count:,.0f} {unit}"
