"""Frames that something else held up: they stand out upwards from their neighbours, one by one."""

from typing import Any

import numpy as np

from ....base.arrays import BoolArray, FloatArray

_NEIGHBOURS = 15  # frames whose median a frame stands out from; a slow episode is longer
_OUT = 6.0  # deviations of what is left of a residual beside its neighbours
_FEWEST = 30


def are_spikes(residual: FloatArray) -> BoolArray:
    """Return which of n successive residuals are spikes, (n,); none of a few frames."""
    from scipy.ndimage import median_filter

    if len(residual) < _FEWEST:
        return np.zeros(len(residual), dtype=np.bool_)
    nearby: Any = median_filter(residual, _NEIGHBOURS, mode="nearest")
    away: FloatArray = residual - nearby
    deviation = 1.4826 * float(np.median(np.abs(away)))
    return away > _OUT * deviation
