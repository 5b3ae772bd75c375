"""Statistics over the time of the path: each frame counts for as long as it weighs."""

import numpy as np

from ...base.arrays import FloatArray


def time_mean(values: FloatArray, weight_ms: FloatArray) -> float | None:
    """Return the mean over time of the frames that have a value, None if none of them weighs.

    Parameters
    ----------
    values, weight_ms : (n,) float64
        NaN where a frame has no value.
    """
    return time_ratio(values, np.where(np.isnan(values), np.nan, 1.0), weight_ms)


def time_ratio(
    numerator: FloatArray, denominator: FloatArray, weight_ms: FloatArray
) -> float | None:
    """Return integral over integral, of frames that have both; None where the latter is 0."""
    known = ~(np.isnan(numerator) | np.isnan(denominator))
    below = float((weight_ms[known] * denominator[known]).sum())
    return float((weight_ms[known] * numerator[known]).sum()) / below if below > 0.0 else None


def time_quantile(values: FloatArray, weight_ms: FloatArray, q: float) -> float | None:
    """Return the least value which, with those below it, holds a share q of the time.

    None if no frame that has a value weighs.
    """
    known = ~np.isnan(values) & (weight_ms > 0.0)
    if not known.any():
        return None
    values, weight_ms = values[known], weight_ms[known]
    order = np.argsort(values, kind="stable")
    reached: FloatArray = np.cumsum(weight_ms[order])
    # A share that is reached exactly, as half of two equal frames, must not be missed by rounding.
    enough = q * float(reached[-1]) * (1.0 - 1e-12)
    at = int(np.searchsorted(reached, enough))
    return float(values[order][at])
