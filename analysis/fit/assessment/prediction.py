"""What a fitted model says of other frames, beside what was measured."""

import numpy as np

from ....base.arrays import FloatArray
from ..design import design_of
from ..estimate import Estimate
from ..fit_frames import Sample
from .posterior_predictive import Draws

_MOST_ROWS = 20_000


def predict(fitted: Estimate, sample: Sample) -> tuple[FloatArray, float]:
    """Return what there is to say of each frame, (4, n), and the deviation of the mean error.

    Of a frame: the error in per cent, whether the interval covers it, the log density, and the
    time measured.
    """
    return predict_by(fitted.draws, fitted, sample)


def predict_by(draws: Draws, fitted: Estimate, sample: Sample) -> tuple[FloatArray, float]:
    """Return what `predict` does, by other draws than those of the fit."""
    sample = seen_rows(sample)
    design = design_of(sample, fitted.terms, fitted.design.unit)
    draws = draws.fitting(len(sample)).elsewhere(np.random.default_rng(1))
    mean, simulated = draws.simulate(design, np.random.default_rng(0))
    low, high = np.quantile(simulated, (0.05, 0.95), axis=0)
    errors = 100.0 * (mean.mean(axis=0) / sample.time_ms - 1.0)
    covered = (sample.time_ms >= low) & (sample.time_ms <= high)
    density = draws.log_density(design, sample.time_ms)
    frames = np.stack((errors, covered, density, sample.time_ms))
    return frames, float((100.0 * (mean / sample.time_ms - 1.0).mean(axis=1)).std())


def seen_rows(sample: Sample) -> Sample:
    """Return frames, of very many some."""
    step = max(1, -(-len(sample) // _MOST_ROWS))
    return sample.rows(np.arange(0, len(sample), step))
