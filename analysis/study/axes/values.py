"""Values of an axis in short: ranges in steps, in equal parts, and in equal ratios."""

from decimal import Decimal

import numpy as np

from ....base.errors import InputError, require_real, require_whole
from .grid import MOST_RUNS

Number = int | float


def step_range(low: Number, high: Number, step: Number) -> list[Number]:
    """Return `low`, `low + step` and so on up to `high`, whole numbers if all three are.

    Raises `InputError` if there would be none, or more than a study can list.
    """
    for name, value in (("from", low), ("to", high), ("step", step)):
        _require_finite(value, name)
    # In decimal, as they were written: 0.1 + 2 · 0.1 is 0.3.
    first, last, by = (Decimal(repr(value)) for value in (low, high, step))
    if by == 0 or (last - first) / by < 0:
        raise InputError(f"step: expected steps that lead from {low} to {high}, got {step}")
    count = int((last - first) / by) + 1
    _require_count(count)
    values = [first + at * by for at in range(count)]
    whole = all(isinstance(value, int) for value in (low, high, step))
    return [int(value) if whole else float(value) for value in values]


def count_range(low: Number, high: Number, count: int, *, log: bool = False) -> list[Number]:
    """Return so many values from `low` to `high`, in equal steps or, with `log`, in equal ratios.

    Values have twelve digits, so that they are the same on every machine; they are whole numbers if
    the ends are and every value is one.

    Raises `InputError` if there are fewer than two or too many, or a ratio has an end that is not
    positive.
    """
    for name, value in (("from", low), ("to", high)):
        _require_finite(value, name)
    require_whole(count, "count", 2)
    _require_count(count)
    if log and not (low > 0 and high > 0):
        raise InputError(f"log: expected ends above 0, got {low} and {high}; leave log out")
    spaced = np.geomspace(low, high, count) if log else np.linspace(low, high, count)
    values = [float(f"{value:.12g}") for value in spaced.tolist()]
    values[0], values[-1] = float(low), float(high)
    whole = isinstance(low, int) and isinstance(high, int)
    if whole and all(value.is_integer() for value in values):
        return [int(value) for value in values]
    return list(values)


def _require_finite(value: Number, name: str) -> None:
    require_real(value, name)
    if not np.isfinite(value):
        raise InputError(f"{name}: expected a finite number, got {value}")


def _require_count(count: int) -> None:
    if count > MOST_RUNS:
        raise InputError(f"range: expected at most {MOST_RUNS:,} values, got {count:,}; take fewer")
