"""The log-posterior that is sampled: priors plus the likelihood of the frames' worth."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from .likelihood import Likelihood
from .priors import Priors
from .stretch import Stretch


@dataclass(frozen=True, slots=True, eq=False)
class LogPosterior:
    """Log density of W parameter vectors at once, but for a constant.

    Attributes
    ----------
    stretch : Stretch or None
        How much wider frames that err alike make it, see `dependence`; None for not at all.
    """

    likelihood: Likelihood
    priors: Priors
    stretch: Stretch | None = None

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log density of (W, D) parameters, (W,); -inf outside the bounds."""
        likelihood, priors = self.likelihood, self.priors
        inside = ((theta >= likelihood.low) & (theta <= likelihood.high)).all(axis=1)
        result = np.full(len(theta), -np.inf)
        if not inside.any():
            return result
        theta = theta[inside]
        at = likelihood.names.index("log_scale")
        density = priors.log_coefficients(theta[:, :at]) + priors.log_scale(theta[:, at])
        if "inverse_dof" in likelihood.names:
            density += priors.log_inverse_dof(theta[:, likelihood.names.index("inverse_dof")])
        if self.stretch is None:
            result[inside] = density + likelihood(theta)
        else:
            result[inside] = density + self.stretch(likelihood, theta)
        return result
