"""Whether the log or the prior says what a coefficient is."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ..sampling.priors import Priors

_UNINFORMED = 0.5
_HALF_NORMAL_VARIANCE = 1.0 - 2.0 / np.pi


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """What of one coefficient's posterior is the prior's.

    Attributes
    ----------
    contraction : float
        1 - posterior variance / prior variance: near 1 where the log informs, near 0 where the
        posterior is the prior.
    shift_sd : float
        How far the posterior mean moves, in posterior deviations, when all coefficients' priors
        are made half or twice as wide; the farther of the two.
    """

    contraction: float
    shift_sd: float

    @property
    def informed(self) -> bool:
        """Whether the log says more than the prior does."""
        return self.contraction > _UNINFORMED and self.shift_sd < _UNINFORMED


def sensitivity(scaled: FloatArray, priors: Priors) -> tuple[Sensitivity, ...]:
    """Return the prior's part in each of K scaled coefficients, from samples (S, K).

    Posteriors under the other priors come from the samples by importance weights (Kallioinen et
    al., Statistics and Computing 34, 2024).
    """
    deviation: FloatArray = scaled.std(axis=0)
    shifts: list[FloatArray] = []
    for factor in (0.5, 2.0):
        other = Priors(priors.mean_ms, priors.widen * factor)
        log_weight = other.log_coefficients(scaled) - priors.log_coefficients(scaled)
        weight: FloatArray = np.exp(log_weight - log_weight.max())
        mean = weight @ scaled / weight.sum()
        shifts.append(np.abs(mean - scaled.mean(axis=0)) / deviation)
    prior_variance = _HALF_NORMAL_VARIANCE * priors.coefficient_sd_ms**2
    return tuple(
        Sensitivity(float(contraction), float(shift))
        for contraction, shift in zip(
            1.0 - deviation**2 / prior_variance, np.max(shifts, axis=0), strict=True
        )
    )
