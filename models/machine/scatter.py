"""How a machine's costs differ from one occasion, and from one scene, to another.

Each draw of a machine has its own factors.  They are quasi-random: the first n draws, where n is a
power of two, have one value of every factor in each n-th of its distribution, so that eight draws
already hold its tails as they should be held.  Each factor by itself is a shuffled, scrambled van
der Corput sequence (Owen, Randomly permuted (t, m, s)-nets and (t, s)-sequences, 1995; Burley,
Practical hash-based Owen scrambling, JCGT 9, 2020).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
from scipy.special import ndtri

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import GPU_PREDICTORS
from .cost import CostModel

SCATTERED = ("base", *GPU_PREDICTORS)
"""Terms that may differ from scene to scene."""

_BITS = 12  # draws beyond 4,096 have the factors of the first ones again
# Of 4,000 seeds that under which factors of the occasion, the base and the kinds of triangles go
# least together in the first 8, 16, 32 and 64 draws: no two of them by more than r = .33.
_SEED = 3005


@dataclass(frozen=True, slots=True)
class Scatter:
    """Spread of GPU times that no posterior of one recording of one scene knows of.

    Attributes
    ----------
    occasion : float
        Standard deviation of the logarithm of a factor of all GPU times, from one occasion of
        recording to another.
    scenes : mapping of str to float
        That of a factor of each term (``base``, or a GPU predictor: its linear, roofline and knee
        coefficients), from scene to scene.
    assumed : bool
        Whether these were not estimated from several occasions and scenes.
    """

    occasion: float = 0.0
    scenes: Mapping[str, float] = field(default_factory=dict[str, float])
    assumed: bool = False

    def __post_init__(self) -> None:
        unknown = sorted(set(self.scenes) - set(SCATTERED))
        if unknown:
            known = ", ".join(SCATTERED)
            raise InputError(f"scatter: expected terms among {known}; got {unknown[0]}")
        for name, sd in (("occasion", self.occasion), *self.scenes.items()):
            # exp(3) is twenty times dearer: a larger spread is a percentage that lost its point.
            if not (np.isfinite(sd) and 0.0 <= sd <= 3.0):
                raise InputError(f"scatter {name}: expected a log-sd from 0 to 3, got {sd}")

    @property
    def any(self) -> bool:
        """Whether any factor differs from 1."""
        return self.occasion > 0.0 or any(sd > 0.0 for sd in self.scenes.values())

    def apply(self, model: CostModel, draw: int) -> CostModel:
        """Return a cost model on the occasion and in the scene of a machine's draw."""
        common = _factor("occasion", self.occasion, draw)
        base, *each = (
            common * _factor(name, self.scenes.get(name, 0.0), draw) for name in SCATTERED
        )
        return CostModel(
            model.base_ms * base,
            model.linear_ms * each,
            model.roofline_ms * each,
            tuple(
                replace(knee, ms=knee.ms * each[GPU_PREDICTORS.index(knee.predictor)])
                for knee in model.knees
            ),
        )


def _factor(name: str, log_sd: float, draw: int) -> float:
    """Return a log-normal factor of median 1, by its name and the draw's number alone."""
    return float(np.exp(log_sd * _scores(name)[draw % (1 << _BITS)])) if log_sd else 1.0


@cache
def _scores(name: str) -> FloatArray:
    """Return standard normal scores by draw, (4096,)."""
    rng = np.random.default_rng((_SEED, *name.encode()))
    at = np.arange(1 << _BITS)
    # Shuffle: a digit is turned by those above it, so that the first 2^m stay within one block of
    # 2^m successive numbers, in another order under each name.
    number = np.zeros_like(at)
    for digit in reversed(range(_BITS)):
        turned = rng.integers(0, 2, 1 << (_BITS - 1 - digit))
        number |= (((at >> digit) & 1) ^ turned[at >> (digit + 1)]) << digit
    # Scramble: a digit after the point is turned by those before it.  2^m successive numbers fall
    # one by one into 2^m equal parts.
    point = np.full(1 << _BITS, 0.5 / (1 << _BITS))
    for digit in range(_BITS):
        turned = rng.integers(0, 2, 1 << digit)
        before = number & ((1 << digit) - 1)
        point += (((number >> digit) & 1) ^ turned[before]) / (2 << digit)
    scores: FloatArray = ndtri(point)
    scores.flags.writeable = False
    return scores
