"""A likelihood made wider about its optimum, with heavier tails, for frames that err alike."""

from dataclasses import dataclass, replace

import numpy as np

from ....base.arrays import FloatArray
from ..assessment.dependence import Dependence
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
    found : what of the frames says so
    """

    center: FloatArray
    moved: FloatArray
    value: float
    shrink: FloatArray
    found: Dependence

    @classmethod
    def of(cls, found: Dependence, center: FloatArray, likelihood: Likelihood) -> "Stretch":
        """Return the stretch of a likelihood with its optimum, K coefficients before the noise."""
        width, whole = len(found.along), len(center)
        moved = center.copy()
        moved[:width] *= 1.0 + found.rise
        # The noise is told as well as what is told best: slow errors blur costs, not scatter.
        shrink = np.eye(whole) / np.sqrt(found.times.min())
        beyond = np.eye(width) - found.along @ found.across
        shrink[:width, :width] = (found.along / np.sqrt(found.times)) @ found.across + beyond
        return cls(center, moved, float(likelihood(center[np.newaxis])[0]), shrink, found)

    def raised(self, share: float) -> "Stretch":
        """Return the same about coefficients that are all larger by a share."""
        moved = self.moved.copy()
        moved[: len(self.found.along)] *= 1.0 + share
        return replace(self, moved=moved)

    def __call__(self, likelihood: Likelihood, theta: FloatArray) -> FloatArray:
        """Return the stretched log-likelihood of (W, D) parameters, (W,).

        The fall from the optimum becomes that of a t: heavier tails where few stretches were seen.
        """
        nearer = self.center + (theta - self.moved) @ self.shrink.T
        fall = self.value - likelihood(nearer)
        dof = self.found.dof
        half = 0.5 * (dof + len(self.center))
        # Uphill, which is where bounds keep the optimum from, the line that touches the t goes on.
        tail = np.log1p(np.maximum(fall, 0.0) * (2.0 / dof))
        return self.value - half * (tail + np.minimum(fall, 0.0) * (2.0 / dof))
