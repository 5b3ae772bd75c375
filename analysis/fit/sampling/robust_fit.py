"""Robust non-negative least squares for times that scatter in proportion to their mean.

The model is ``time = m · (1 + scale · z)`` with ``m = base + Σ coefficient · predictor``, all of
them >= 0, and z of Student's t.  Iteratively reweighted least squares: a frame whose residual
relative to the mean is r counts with weight ``(dof + 1) / (dof + (r / scale)²) / m²``, which is
the expectation step for Student's t (Lange, Little, Taylor, "Robust statistical modeling using the
t distribution", JASA 84, 1989), and each weighted problem is solved by scipy's `nnls` (Lawson,
Hanson, "Solving least squares problems", 1974).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....base.arrays import FloatArray

_STEPS = 500
_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class RobustFit:
    """A fitted linear model of times.

    Attributes
    ----------
    base_ms : cost of a frame that draws nothing, >= 0
    slopes_ms : (P,) milliseconds per unit of each predictor, >= 0
    scale : relative scale of the residuals
    """

    base_ms: float
    slopes_ms: FloatArray
    scale: float

    def predict(self, predictors: FloatArray) -> FloatArray:
        """Return mean times in milliseconds of (n, P) predictors, (n,)."""
        return self.base_ms + predictors @ self.slopes_ms


def robust_nnls(predictors: FloatArray, time_ms: FloatArray, *, dof: float = 4.0) -> RobustFit:
    """Fit times to predictors.

    Parameters
    ----------
    predictors
        (n, P), finite, >= 0, more rows than columns.
    time_ms
        (n,), finite, > 0.
    dof
        Degrees of freedom of Student's t; large values give ordinary relative least squares.
    """
    from scipy.optimize import nnls

    rows, width = len(time_ms), len(predictors[0])
    assert rows > width + 1, "whoever gathers frames sees to it that there are enough"
    design = np.column_stack([np.ones(rows), predictors])
    unit = design.max(axis=0)  # so that the solver's tolerance means the same for every column
    unit[unit == 0.0] = 1.0
    design /= unit
    mean = time_ms.copy()
    weight = np.ones(rows)
    solution: FloatArray = np.zeros(width + 1)
    scale = 0.0
    for _ in range(_STEPS):
        root = np.sqrt(weight) / mean
        before = solution
        answer: Any = nnls(design * root[:, np.newaxis], time_ms * root)
        solution = np.asarray(answer[0], dtype=np.float64)
        mean = np.maximum(design @ solution, 1e-3 * time_ms)
        residual = (time_ms - mean) / mean
        scale = max(float(np.sqrt(np.mean(weight * residual**2))), 1e-9)
        weight = (dof + 1.0) / (dof + (residual / scale) ** 2)
        if np.abs(solution - before).max() <= _TOLERANCE * np.abs(solution).max():
            break
    per_unit: FloatArray = solution / unit
    return RobustFit(float(per_unit[0]), per_unit[1:], scale)
