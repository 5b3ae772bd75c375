"""Whether the machine is the profile's: another one costs the same factor whatever is drawn."""

from collections.abc import Sequence
from math import exp, hypot, log, sqrt

import numpy as np

from ....models.machine.scatter import Scatter
from ..validation_result import MachineFactor

_FAR = 1.25
"""Factor beyond which a machine is another: occasions on one machine differ by some 9 % (sd)."""

_SURE = 2.0
"""Standard deviations of what the profile says of occasions and scenes that it has to be beyond."""

_STEADY = 1.0 / 3.0
"""Scatter of the factor's logarithm, as a part of it, up to which it is one factor."""


def machine_factor(
    ratios: Sequence[float], scatter: Scatter | None = None, scenes: int = 1
) -> MachineFactor | None:
    """Return the common factor of measured over predicted times, None of no policy.

    Parameters
    ----------
    ratios
        `cost_ratio` of every policy on every path.
    scatter
        Between occasions and scenes, as the profile has it: it is no sign of another machine.
    scenes
        How many scenes the paths are in.
    """
    if not ratios:
        return None
    logs = np.log(ratios)
    middle = float(np.median(logs))
    spread = float(logs.std(ddof=1)) if len(logs) > 1 else 0.0
    another = abs(middle) > _far(scatter, scenes) and spread <= _STEADY * abs(middle)
    return MachineFactor(exp(middle), min(ratios), max(ratios), 100.0 * spread, another)


def _far(scatter: Scatter | None, scenes: int) -> float:
    """Return the logarithm of a factor that neither an occasion nor so many scenes explain."""
    if scatter is None:
        return log(_FAR)
    # One term may be all that a scene costs.
    between = max(scatter.scenes.values(), default=0.0) / sqrt(scenes)
    return max(log(_FAR), _SURE * hypot(scatter.occasion, between))


def advice(machine: MachineFactor, hardware: str) -> str:
    """Return what to do about a profile of another machine."""
    return (
        f"all frames take {machine.factor:.2f} times what {hardware} says ({machine.low:.2f} to "
        f"{machine.high:.2f} by policy and path): it is the profile of another machine, or of "
        "another state of this one; calibrate this machine: lodbench record --calibrate "
        "--scene plaza --out calibration.parquet, then lodbench fit calibration.parquet "
        "--target frame_ms --out mine.toml"
    )
