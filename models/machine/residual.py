"""How measured times scatter about a cost model's mean."""

from dataclasses import dataclass
from itertools import accumulate
from math import sqrt
from typing import Literal

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError

ResidualKind = Literal["none", "gaussian", "student-t", "lognormal"]


@dataclass(frozen=True, slots=True)
class Residual:
    """Multiplicative noise: time = mean · (1 + scale · z), or mean · exp(scale · z) if lognormal.

    What a linear model misses changes slowly with the view, so z of successive frames may be
    correlated: ``z_0 = e_0, z_k = c · z_(k-1) + sqrt(1 - c²) · e_k`` with independent e of the
    kind named, which keeps the variance of z that of e.

    Attributes
    ----------
    kind : "none", "gaussian", "student-t" or "lognormal"
    scale : float
        Relative scale of z, not negative.
    dof : float
        Degrees of freedom of student-t.
    floor : float
        Smallest factor that a draw may take: a frame never takes less than this share of its mean.
    correlation : float
        c, in [0, 1).
    """

    kind: ResidualKind = "none"
    scale: float = 0.0
    dof: float = 4.0
    floor: float = 0.2
    correlation: float = 0.0

    def __post_init__(self) -> None:
        good = np.isfinite((self.scale, self.dof, self.floor)).all()
        if not good or self.scale < 0 or self.dof <= 0 or not 0 <= self.floor <= 1:
            raise InputError(
                "residual: expected scale >= 0, dof > 0 and floor in [0, 1], got "
                f"scale {self.scale}, dof {self.dof}, floor {self.floor}"
            )
        if not 0.0 <= self.correlation < 1.0:
            raise InputError(f"residual: expected correlation in [0, 1), got {self.correlation}")

    def factors(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return factors to multiply the mean times of `count` successive frames by, >= `floor`."""
        if self.kind == "none" or self.scale == 0.0:
            return np.ones(count)
        if self.kind == "student-t":
            z: FloatArray = rng.standard_t(self.dof, count)
        else:
            z = rng.standard_normal(count)
        if self.correlation > 0.0:
            z = _autoregressive(z, self.correlation)
        factors = np.exp(self.scale * z) if self.kind == "lognormal" else 1.0 + self.scale * z
        return np.maximum(factors, self.floor)


def _autoregressive(e: FloatArray, correlation: float) -> FloatArray:
    """Return ``z_0 = e_0, z_k = c · z_(k-1) + sqrt(1 - c²) · e_k``."""
    share = sqrt(1.0 - correlation**2)

    def step(before: float, now: float) -> float:
        return correlation * before + share * now

    values: list[float] = e.tolist()
    return np.array(list(accumulate(values, step)))
