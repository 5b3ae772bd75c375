"""A square grid."""

import math

import numpy as np

from ....base.arrays import FloatArray


def grid(radius_m: FloatArray, _side_m: float | None, _rng: np.random.Generator) -> FloatArray:
    """Return centres (N, 2) row by row, as far apart as the two largest discs need."""
    count = len(radius_m)
    columns = math.ceil(math.sqrt(count))
    index = np.arange(count)
    cells = np.stack((index % columns, index // columns), axis=1).astype(np.float64)
    return (cells - cells.max(axis=0) / 2.0) * (2.0 * float(radius_m.max()))
