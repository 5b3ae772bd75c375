"""Numbers as tables, pages and sentences show them."""

ABSENT = "–"


def format_value(value: float | None, *, percent: bool = False) -> str:
    """Return three significant digits, or a dash for what a run cannot have."""
    if value is None:
        return ABSENT
    if percent:
        value *= 100.0
    size = abs(value)
    if size == 0.0:
        return "0"
    if size >= 99.95:
        return f"{value:,.0f}"
    if size < 0.0005:
        return f"{value:.0e}".replace("e-0", "e-")
    return f"{value:.{1 if size >= 9.995 else 2 if size >= 0.9995 else 3}f}"


def format_span(low: float | None, high: float | None, *, percent: bool = False) -> str:
    """Return an interval in words, or nothing where there is none."""
    if low is None:
        return ""
    return f"{format_value(low, percent=percent)} to {format_value(high, percent=percent)}"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with the word for what there are so many of; many are `one` and an s."""
    return f"{number:,} {one if number == 1 else many or f'{one}s'}"
