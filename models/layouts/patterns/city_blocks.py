"""City blocks: lots about a courtyard, streets between the blocks."""

import math

import numpy as np

from ....base.arrays import FloatArray

_EDGE = 6  # lots along a block's edge; the lots inside stay empty, as a courtyard
_STREET_M = 10.0


def city(radius_m: FloatArray, _side_m: float | None, _rng: np.random.Generator) -> FloatArray:
    """Return centres (N, 2): 20 lots a block, blocks in a square, streets 10 m wide."""
    lot = 2.0 * float(radius_m.max())
    ring = [(i, j) for j in range(_EDGE) for i in range(_EDGE) if {i, j} & {0, _EDGE - 1}]
    count = len(radius_m)
    block, place = np.divmod(np.arange(count), len(ring))
    columns = math.ceil(math.sqrt(math.ceil(count / len(ring))))
    corner = np.stack((block % columns, block // columns), axis=1) * (_EDGE * lot + _STREET_M)
    centers = corner + np.array(ring, dtype=np.float64)[place] * lot
    return centers - (centers.min(axis=0) + centers.max(axis=0)) / 2.0
