"""Units of time and length that files have, and what a clock without one is taken for."""

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ....base.nearest_names import unknown_name

TIME_UNITS_S = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}

_SINCE_1970 = (("ns", 1e17), ("us", 1e14), ("ms", 1e11), ("s", 1e8))
"""Clock times from 1973 on are above these."""


def require_unit(name: str, units: dict[str, float], what: str) -> float:
    """Return a unit in seconds or metres; raises `InputError` if it is unknown."""
    if name not in units:
        raise InputError(f"{what}: {unknown_name(name, list(units))}")
    return units[name]


def guess_time_unit(times: FloatArray) -> str | None:
    """Return the unit in which a clock is one: by its reading, else by its interval.

    Poses are taken to be 1 ms to 1 s apart.  None where the interval fits no unit, or times only
    count the poses.
    """
    if len(times) < 2:
        return "s"
    reading = float(np.abs(times).max())
    for unit, least in _SINCE_1970:
        if reading > least:
            return unit
    steps = np.diff(times)
    step = float(np.median(steps))
    if step == 1.0 and np.all(times == np.round(times)):
        return None  # numbers of frames, some of which may be missing
    for unit, seconds in TIME_UNITS_S.items():
        if 1e-3 <= step * seconds <= 1.0:
            return unit
    return "s" if 0.0 <= step <= 60.0 else None
