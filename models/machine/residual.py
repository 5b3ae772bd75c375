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
    """Multiplicative noise: time = mean · fast noise · slow state · spike.

    The fast noise is 1 + scale · z, or exp(scale · z) if lognormal.  What a linear model misses
    changes slowly with the view, so z of successive frames may be correlated: ``z_0 = e_0, z_k =
    c · z_(k-1) + sqrt(1 - c²) · e_k`` with independent e of the kind named, so that the variance of
    z is that of e.  The slow state is of the machine, not of its frames: a function of time that
    frames of every policy meet alike.  Spikes hit single frames and only ever add.

    Attributes
    ----------
    kind : "none", "gaussian", "student-t" or "lognormal"
    scale : float
        Relative scale of z, not negative.
    dof : float
        Degrees of freedom of student-t.
    floor : float
        Smallest factor of the fast noise, in [0, 1].
    correlation : float
        c, in [0, 1).
    slow_scale : float
        Relative standard deviation of the slow state, from 0 (there is none) to 1.
    slow_time_s : float
        Seconds in which its correlation falls to 1/e, at least 0.01.
    spike_share : float
        Probability that a frame is hit by a spike, in [0, 1].
    spike_scale : float
        Mean of the exponential e of which such a frame takes 1 + e times as long, not negative.
    """

    kind: ResidualKind = "none"
    scale: float = 0.0
    dof: float = 4.0
    floor: float = 0.2
    correlation: float = 0.0
    slow_scale: float = 0.0
    slow_time_s: float = 1.0
    spike_share: float = 0.0
    spike_scale: float = 0.0

    def __post_init__(self) -> None:
        good = np.isfinite((self.scale, self.dof, self.floor)).all()
        if not good or self.scale < 0 or self.dof <= 0 or not 0 <= self.floor <= 1:
            raise InputError(
                "residual: expected scale >= 0, dof > 0 and floor in [0, 1], got "
                f"scale {self.scale}, dof {self.dof}, floor {self.floor}"
            )
        if not 0.0 <= self.correlation < 1.0:
            raise InputError(f"residual: expected correlation in [0, 1), got {self.correlation}")
        self._require_slow_and_spikes()

    def _require_slow_and_spikes(self) -> None:
        for name, low, high in (
            ("slow_scale", 0.0, 1.0),
            ("slow_time_s", 0.01, 1e6),  # below, it is fast noise; above, it never moves
            ("spike_share", 0.0, 1.0),
            ("spike_scale", 0.0, 1e3),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"residual: expected {name} from {low} to {high}, got {value}")

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

    def spikes(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return the factors, 1 or more, by which spikes prolong `count` successive frames."""
        hit = rng.random(count) < self.spike_share
        return 1.0 + np.where(hit, rng.exponential(self.spike_scale, count), 0.0)


def _autoregressive(e: FloatArray, correlation: float) -> FloatArray:
    """Return ``z_0 = e_0, z_k = c · z_(k-1) + sqrt(1 - c²) · e_k``."""
    share = sqrt(1.0 - correlation**2)

    def step(before: float, now: float) -> float:
        return correlation * before + share * now

    values: list[float] = e.tolist()
    return np.array(list(accumulate(values, step)))
