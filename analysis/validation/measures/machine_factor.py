"""Whether the machine is the profile's: another one costs the same factor whatever is drawn."""

from collections.abc import Sequence
from math import exp, log

import numpy as np

from ..validation_result import MachineFactor

_FAR = 1.25
"""Factor beyond which a machine is another: occasions on one machine differ by some 9 % (sd)."""

_STEADY = 1.0 / 3.0
"""Scatter of the factor's logarithm, as a part of it, up to which it is one factor."""


def machine_factor(ratios: Sequence[float]) -> MachineFactor | None:
    """Return the common factor of measured over predicted times, None of no policy.

    Parameters
    ----------
    ratios
        `cost_ratio` of every policy on every path.
    """
    if not ratios:
        return None
    logs = np.log(ratios)
    middle = float(np.median(logs))
    scatter = float(logs.std(ddof=1)) if len(logs) > 1 else 0.0
    another = abs(middle) > log(_FAR) and scatter <= _STEADY * abs(middle)
    return MachineFactor(exp(middle), min(ratios), max(ratios), 100.0 * scatter, another)


def advice(machine: MachineFactor, hardware: str) -> str:
    """Return what to do about a profile of another machine."""
    return (
        f"all frames take {machine.factor:.2f} times what {hardware} says ({machine.low:.2f} to "
        f"{machine.high:.2f} by policy and path): it is the profile of another machine; calibrate "
        "this machine: lodbench record --calibrate --scene plaza --out calibration.parquet, then "
        "lodbench fit calibration.parquet --target frame_ms --out mine.toml"
    )
