"""The log-posterior that is sampled: priors plus the likelihood of the frames' worth."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from .likelihood import Likelihood
from .priors import Priors


@dataclass(frozen=True, slots=True, eq=False)
class LogPosterior:
    """Log density of W parameter vectors at once, but for a constant.

    Attributes
    ----------
    worth : float
        Share of a frame that a frame counts for, in (0, 1]: less than 1 where successive frames
        err alike, see `dependence`.
    """

    likelihood: Likelihood
    priors: Priors
    worth: float = 1.0

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
        if likelihood.names[-1] == "inverse_dof":
            density += priors.log_inverse_dof(theta[:, -1])
        result[inside] = density + self.worth * likelihood(theta)
        return result
