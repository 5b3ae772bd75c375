"""What is believed of the parameters before the log is seen: little, and said in the output."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray

DOF_LOW, DOF_HIGH = 1.0, 500.0
_TIMES_MEAN = 2.0
_DOF_RATE = 0.1


@dataclass(frozen=True, slots=True)
class Priors:
    """Priors of scaled coefficients and noise.

    Attributes
    ----------
    mean_ms : mean measured time, which sets the size of everything
    widen : factor on the width of the coefficients' priors, to see whether it matters
    """

    mean_ms: float
    widen: float = 1.0

    @property
    def coefficient_sd_ms(self) -> float:
        """Scale of the half-normal prior of each scaled coefficient."""
        return _TIMES_MEAN * self.widen * self.mean_ms

    def log_coefficients(self, scaled: FloatArray) -> FloatArray:
        """Return the log density of (W, K) scaled coefficients >= 0, but for a constant, (W,)."""
        return -0.5 * np.einsum("wk,wk->w", scaled, scaled) / self.coefficient_sd_ms**2

    def log_scale(self, log_scale: FloatArray) -> FloatArray:
        """Return the log density of the logarithm of the noise's scale in ms, (W,)."""
        return log_scale - 0.5 * np.exp(2.0 * log_scale) / self.mean_ms**2

    def log_inverse_dof(self, inverse_dof: FloatArray) -> FloatArray:
        """Return the log density of 1/dof, (W,): gamma of shape 2 and rate 0.1 on dof."""
        return -3.0 * np.log(inverse_dof) - _DOF_RATE / inverse_dof

    def describe(self, model: str) -> tuple[str, ...]:
        """Return the priors in words, with their reasons."""
        coefficients = (
            f"each coefficient >= 0, half-normal: at its column's mean it costs up to about "
            f"{self.coefficient_sd_ms:.4g} ms, twice the mean time, since no part of a frame "
            "costs more than the frame"
        )
        scale = (
            f"scale of the noise half-normal, {self.mean_ms:.4g} ms: frames do not scatter by "
            "more than they take"
        )
        if model == "gaussian":
            return coefficients, scale
        growth = (
            "share of the scale that grows with the mean uniform on 0 to 1: constant and "
            "proportional scatter are equally plausible"
        )
        dof = (
            f"degrees of freedom gamma(2, {_DOF_RATE:g}) on {DOF_LOW:g} to {DOF_HIGH:g}: from very "
            "heavy tails to nearly Gaussian (Juárez and Steel, J. Business & Economic Statistics "
            "28, 2010)"
        )
        return coefficients, scale, growth, dof
