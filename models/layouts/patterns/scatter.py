"""Objects scattered evenly over a square."""

import numpy as np

from ....base.arrays import FloatArray
from ..packing import default_side_m, pack_discs, require_side

_COVERAGE = 0.25  # of the square chosen when no side is given
_MAX_COVERAGE = 0.4  # random placement jams at 0.547; towards that it takes forever


def scatter(radius_m: FloatArray, side_m: float | None, rng: np.random.Generator) -> FloatArray:
    """Return uniformly random centres (N, 2) of discs that do not overlap.

    Raises `InputError` if the discs would cover more than 40 % of the square.
    """
    side = default_side_m(radius_m, _COVERAGE) if side_m is None else side_m
    require_side(side, default_side_m(radius_m, _MAX_COVERAGE), len(radius_m), "scatter")

    def propose(count: int) -> FloatArray:
        return rng.uniform(-side / 2.0, side / 2.0, (count, 2))

    return pack_discs(radius_m, side, propose, "scatter")
