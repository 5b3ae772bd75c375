"""How measured times scatter about a cost model's mean."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import InputError
from .arrays import FloatArray

__all__ = ["Residual", "ResidualKind"]

ResidualKind = Literal["none", "gaussian", "student-t", "lognormal"]


@dataclass(frozen=True, slots=True)
class Residual:
    """Multiplicative noise: time = mean · (1 + scale · z), or mean · exp(scale · z) if lognormal.

    Attributes
    ----------
    kind : "none", "gaussian", "student-t" or "lognormal"
    scale : float
        Relative scale of z, not negative.
    dof : float
        Degrees of freedom of student-t.
    floor : float
        Smallest factor that a draw may take: a frame never takes less than this share of its mean.
    """

    kind: ResidualKind = "none"
    scale: float = 0.0
    dof: float = 4.0
    floor: float = 0.2

    def __post_init__(self) -> None:
        good = np.isfinite((self.scale, self.dof, self.floor)).all()
        if not good or self.scale < 0 or self.dof <= 0 or not 0 <= self.floor <= 1:
            raise InputError(
                "residual: expected scale >= 0, dof > 0 and floor in [0, 1], got "
                f"scale {self.scale}, dof {self.dof}, floor {self.floor}"
            )

    def factors(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return `count` factors to multiply mean times by, at least `floor`."""
        if self.kind == "none" or self.scale == 0.0:
            return np.ones(count)
        if self.kind == "student-t":
            z = rng.standard_t(self.dof, count)
        else:
            z = rng.standard_normal(count)
        factors = np.exp(self.scale * z) if self.kind == "lognormal" else 1.0 + self.scale * z
        return np.maximum(factors, self.floor)
