"""How many independent frames a log is worth.

What a cost model misses changes slowly with the view, so successive frames err alike, and a
likelihood that multiplies frames as if they were independent is too sure of itself.  The
likelihood is therefore raised to a power, the worth of a frame: the magnitude adjustment of
composite likelihoods (Pauli, Racugno, Ventura, Statistica Sinica 21, 2011), here one over the mean
integrated autocorrelation time of the scores, whitened.
"""

from typing import Any

import emcee
import numpy as np

from ...models.arrays import FloatArray
from .design import Design
from .likelihood import Likelihood
from .sample import Sample

__all__ = ["frame_worth", "standard_residuals"]

_STANDS_OUT = 2.0  # deviations of chance
_FEWEST = 30  # frames, below which nothing can be said


def standard_residuals(
    sample: Sample, design: Design, theta: FloatArray, names: tuple[str, ...]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means (n,), scales (n,) and residuals over scale (n,) at one parameter vector."""
    width = len(design.names)
    mean = design.mean(theta[np.newaxis, :width])[0]
    scale = np.full(len(mean), np.exp(theta[width]))
    if "growth" in names:
        growth = theta[names.index("growth")]
        scale *= 1.0 - growth + growth * mean / sample.time_ms.mean()
    return mean, scale, (sample.time_ms - mean) / scale


def frame_worth(sample: Sample, design: Design, theta: FloatArray, likelihood: Likelihood) -> float:
    """Return the share of a frame that each frame counts for, in (0, 1].

    It is 1 where the scores' correlation from frame to frame does not stand out of chance.
    """
    _, scale, z = standard_residuals(sample, design, theta, likelihood.names)
    pull = z
    if likelihood.names[-1] == "inverse_dof":
        dof = 1.0 / theta[-1]
        pull = (dof + 1.0) * z / (dof + z**2)
    scores = _whitened((design.columns * (pull / scale)).T)
    weighted, rows = 0.0, 0
    for series in np.unique(sample.series):
        part = scores[sample.series == series]
        if len(part) >= _FEWEST:
            weighted += len(part) * _inflation(part)
            rows += len(part)
    return rows / weighted if rows else 1.0


def _whitened(scores: FloatArray) -> FloatArray:
    """Return uncorrelated scores of variance 1, (n, at most K)."""
    centered = scores - scores.mean(axis=0)
    left, values, _ = np.linalg.svd(centered, full_matrices=False)
    return left[:, values > 1e-9 * values.max()] * np.sqrt(len(scores))


def _inflation(scores: FloatArray) -> float:
    """Return the mean integrated autocorrelation time of columns of successive scores, >= 1."""
    away = scores - scores.mean(axis=0)
    neighbours = (away[1:] * away[:-1]).sum(axis=0) / (away**2).sum(axis=0)
    if neighbours.mean() < _STANDS_OUT / np.sqrt(len(scores)):
        return 1.0
    tau: Any = emcee.autocorr.integrated_time(scores, tol=0, has_walkers=False)
    return float(np.maximum(np.asarray(tau, dtype=np.float64), 1.0).mean())
