"""Groves: clusters of objects with a few strays between."""

import numpy as np

from ....base.arrays import FloatArray
from ..packing import default_side_m, pack_discs, require_side

_COVERAGE = 0.15  # of the square chosen when no side is given
_MAX_COVERAGE = 0.3
_GROVE = 40  # objects a grove on average
_SPREAD = 8.0  # standard deviation of a grove in mean radii: 31 % covered at its heart
_STRAYS = 0.25


def forest(radius_m: FloatArray, side_m: float | None, rng: np.random.Generator) -> FloatArray:
    """Return centres (N, 2) in groves: three of four about random hearts, the rest anywhere.

    Discs do not overlap, so that trunks keep their distance as in Poisson-disc sampling.

    Raises `InputError` if the discs would cover more than 30 % of the square.
    """
    side = default_side_m(radius_m, _COVERAGE) if side_m is None else side_m
    require_side(side, default_side_m(radius_m, _MAX_COVERAGE), len(radius_m), "forest")
    hearts = rng.uniform(-side / 2.0, side / 2.0, (len(radius_m) // _GROVE + 1, 2))
    spread = _SPREAD * float(radius_m.mean())

    def propose(count: int) -> FloatArray:
        grove = hearts[rng.integers(len(hearts), size=count)]
        near = grove + rng.normal(0.0, spread, (count, 2))
        anywhere = rng.uniform(-side / 2.0, side / 2.0, (count, 2))
        return np.where(rng.random((count, 1)) < _STRAYS, anywhere, near)

    return pack_discs(radius_m, side, propose, "forest")
