"""What each log of a sample says by itself of the coefficients of a design."""

import numpy as np

from ...base.arrays import FloatArray
from .assessment.dependence import Dependence, Frames, dependence
from .fit_frames import Origin
from .sampling.between_logs import LogSummary

_ROUNDS = 50
_SETTLED = 1e-6
_PLAIN = 1e-6  # of the largest direction, below which a log says nothing


def summary_of(
    frames: Frames, growth: float, reference_ms: float, pooled: FloatArray, origin: Origin
) -> tuple[LogSummary, FloatArray, Dependence]:
    """Return what a log says, the means of its frames at its own optimum, and their dependence.

    Parameters
    ----------
    frames
        Of one log, about the optimum of all.
    growth, reference_ms
        How the noise's scale grows with the mean, as of all logs.
    pooled
        (K,), that optimum, where directions stay of which the log says nothing.
    """
    scaled, mean, scale = _own_optimum(frames, growth, reference_ms, pooled)
    own = Frames(scaled, frames.slopes, mean, scale, frames.time_ms, frames.series, frames.dof)
    found = dependence(own)
    rows = found.across * np.sqrt(len(mean) / found.times)[:, np.newaxis]
    return LogSummary(rows, rows @ scaled * (1.0 + found.rise), origin), mean, found


def _own_optimum(
    frames: Frames, growth: float, reference_ms: float, pooled: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return coefficients, means and scales of one log, by iteratively reweighted least squares.

    Coefficients may be negative here: bounds are for what all logs say together.
    """
    columns, size = frames.slopes.T, float(frames.scale.mean())
    scaled, mean = pooled.copy(), pooled @ frames.slopes
    least = 1e-3 * frames.time_ms
    scale = frames.scale
    for _ in range(_ROUNDS):
        shape = 1.0 - growth + growth * np.maximum(mean, least) / reference_ms
        z = (frames.time_ms - mean) / (size * shape)
        weight = np.ones(len(z)) if frames.dof is None else (frames.dof + 1.0) / (frames.dof + z**2)
        size *= float(np.sqrt(np.mean(weight * z**2)))
        root = np.sqrt(weight) / shape
        step = np.linalg.lstsq(
            columns * root[:, np.newaxis], (frames.time_ms - mean) * root, rcond=_PLAIN
        )[0]
        scaled, mean = scaled + step, np.maximum((scaled + step) @ frames.slopes, least)
        scale = size * shape
        if np.abs(step).max() < _SETTLED * np.abs(scaled).max():
            break
    return scaled, mean, scale
