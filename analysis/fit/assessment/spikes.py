"""Frames that something else held up: they stand out upwards from their neighbours, one by one."""

from typing import Any

import numpy as np

from ....base.arrays import BoolArray, FloatArray

_NEIGHBOURS = 15  # frames whose median a frame stands out from; a slow episode is longer
_OUT = 6.0  # deviations of what is left of a residual beside its neighbours
_FEWEST = 30


def are_spikes(residual: FloatArray) -> BoolArray:
    """Return which of n successive residuals are spikes, (n,); none of a few frames."""
    if len(residual) < _FEWEST:
        return np.zeros(len(residual), dtype=np.bool_)
    nearby, limit = beside_neighbours(residual)
    return residual - nearby > limit


def beside_neighbours(residual: FloatArray) -> tuple[FloatArray, float]:
    """Return the median of each residual's neighbours, (n,), and from where on one is a spike."""
    from scipy.ndimage import median_filter

    nearby: Any = median_filter(residual, _NEIGHBOURS, mode="nearest")
    return nearby, _OUT * 1.4826 * float(np.median(np.abs(residual - nearby)))
