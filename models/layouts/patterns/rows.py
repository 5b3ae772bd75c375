"""Rows with aisles between them, as shelves, orchards and car parks."""

import math

import numpy as np

from ....base.arrays import FloatArray


def rows(radius_m: FloatArray, _side_m: float | None, _rng: np.random.Generator) -> FloatArray:
    """Return centres (N, 2): discs side by side along x, an aisle as wide as a row between rows."""
    count = len(radius_m)
    pitch = 4.0 * float(radius_m.max())
    length = 2.0 * float(radius_m.sum())
    lines = min(count, max(1, round(math.sqrt(length / pitch))))
    centers = np.empty((count, 2))
    for line, members in enumerate(np.array_split(np.arange(count), lines)):
        end = np.cumsum(2.0 * radius_m[members])
        centers[members, 0] = end - radius_m[members] - end[-1] / 2.0
        centers[members, 1] = (line - (lines - 1) / 2.0) * pitch
    return centers
