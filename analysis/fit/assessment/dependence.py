"""How many independent frames a log is worth.

What a cost model misses changes slowly with the view, so successive frames err alike; and no noise
is quite Student's t.  A likelihood that multiplies frames as if they were independent and its noise
true is too sure of itself.  It is therefore raised to a power, the worth of a frame: the magnitude
adjustment of composite likelihoods (Pauli, Racugno, Ventura, Statistica Sinica 21, 2011), the
number of coefficients over the trace of ``H⁻¹ J``, H the curvature and J the long-run variance of
the scores.
"""

from typing import Any

import emcee
import numpy as np

from ....base.arrays import FloatArray
from ..design import Design
from ..fit_frames import Sample
from ..sampling.likelihood import Likelihood
from .posterior_predictive import Draws

_STANDS_OUT = 2.0  # deviations of chance
_FEWEST = 30  # frames, below which nothing can be said of their order
_LEAST_STIFF = 0.1  # mean curvature of a frame's likelihood; outliers' own is negative
_LEAST = 1e-9  # curvature, of the largest, below which a direction is not looked at


def frame_worth(sample: Sample, design: Design, theta: FloatArray, likelihood: Likelihood) -> float:
    """Return the share of a frame that each frame counts for, in (0, 1].

    It is one over the mean, over K directions in which the likelihood is equally curved, of the
    long-run variance of the scores, which is 1 where the model is true.
    """
    draws = Draws(likelihood.names, theta[np.newaxis], float(sample.time_ms.mean()))
    mean, scale = (moment[0] for moment in draws.moments(design))
    z = (sample.time_ms - mean) / scale
    pull, stiffness = z, 1.0
    if likelihood.names[-1] == "inverse_dof":
        dof = 1.0 / theta[-1]
        pull = (dof + 1.0) * z / (dof + z**2)
        curvature: FloatArray = (dof + 1.0) * (dof - z**2) / (dof + z**2) ** 2
        stiffness = max(float(curvature.mean()), _LEAST_STIFF)
    columns = design.columns / scale
    values, vectors = np.linalg.eigh(stiffness * columns @ columns.T / len(z))
    good = values > _LEAST * values.max()
    scores = (columns * pull).T @ vectors[:, good] / np.sqrt(values[good])
    variance = 0.0
    for log in np.unique(sample.series):
        part = scores[sample.series == log]
        variance += len(part) / len(z) * _long_run_variance(part)
    return min(1.0, 1.0 / variance)


def _long_run_variance(scores: FloatArray) -> float:
    """Return the variance of columns of successive scores times their autocorrelation time."""
    away = scores - scores.mean(axis=0)
    variance: FloatArray = (away**2).mean(axis=0)
    neighbours: FloatArray = (away[1:] * away[:-1]).mean(axis=0) / variance
    if len(scores) < _FEWEST or neighbours.mean() < _STANDS_OUT / np.sqrt(len(scores)):
        return float(variance.mean())
    tau: Any = emcee.autocorr.integrated_time(scores, tol=0, has_walkers=False)
    return float((variance * np.maximum(np.asarray(tau, dtype=np.float64), 1.0)).mean())
