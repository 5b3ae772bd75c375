"""A likelihood made wider about its optimum, with heavier tails, for frames that err alike."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from .likelihood import Likelihood


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """How a log-likelihood of D parameters is stretched.

    Attributes
    ----------
    center : (D,) float64
        The optimum.
    moved : (D,) float64
        Where it is moved to.
    value : the log-likelihood at the optimum
    shrink : (D, D) float64
        What takes a step away from the optimum to the shorter one that is as unlikely.
    dof : degrees of freedom of the t that a normal posterior becomes
    times : (k,) float64
        By how much the variance grows along each direction of the coefficients, that of the mean
        frame's cost first.
    covariance : (K, K) float64
        Of the coefficients as the log alone tells them, but for the t's tails.
    """

    center: FloatArray
    moved: FloatArray
    value: float
    shrink: FloatArray
    dof: float
    times: FloatArray
    covariance: FloatArray

    @property
    def worth(self) -> float:
        """Share of an independent frame that a frame is worth for the mean frame's cost."""
        return 1.0 / float(self.times[0])

    def __call__(self, likelihood: Likelihood, theta: FloatArray) -> FloatArray:
        """Return the stretched log-likelihood of (W, D) parameters, (W,)."""
        nearer = self.center + (theta - self.moved) @ self.shrink.T
        fall = self.value - likelihood(nearer)
        half = 0.5 * (self.dof + len(self.center))
        # Uphill, which is where bounds keep the optimum from, the line that touches the t goes on.
        tail = np.log1p(np.maximum(fall, 0.0) * (2.0 / self.dof))
        return self.value - half * (tail + np.minimum(fall, 0.0) * (2.0 / self.dof))
