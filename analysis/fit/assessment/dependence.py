"""How many independent frames a log is worth, and how much wider that makes the posterior.

What a cost model misses changes slowly with the view or the machine, so successive frames err
alike; and no noise is quite Student's t.  A likelihood that multiplies frames as if they were
independent and its noise true is too sure of itself, and not in all directions alike: where views
come in any order, slow errors blur the cost of the mean frame and hardly the difference that a
triangle makes.  So the likelihood is stretched about its optimum, in each direction by what the
scores of the frames say (the curvature adjustment of composite likelihoods: Ribatet, Cooley,
Davison, Statistica Sinica 22, 2012).  The first direction is that of the mean frame's cost.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import FloatArray
from ..design import Design
from ..fit_frames import Sample
from ..sampling.likelihood import Likelihood
from ..sampling.stretch import Stretch
from .posterior_predictive import Draws
from .slow_error import SlowError, slow_error
from .spikes import are_spikes

_LEAST_STIFF = 0.1  # mean curvature of a frame's likelihood; outliers' own is negative
_LEAST = 1e-9  # curvature, of the largest, below which a direction is not looked at


@dataclass(frozen=True, slots=True, eq=False)
class Directions:
    """K or fewer directions of the coefficients in which a likelihood is equally curved.

    Attributes
    ----------
    along : (K, k) float64
        The directions as columns; the mean frame's cost changes along the first alone.
    across : (k, K) float64
        What takes coefficients to their places along each.
    scores : (n, k) float64
        Slopes of each frame's log-likelihood along them; of mean square 1 if the model is true.
    """

    along: FloatArray
    across: FloatArray
    scores: FloatArray


def directions(columns: FloatArray, pull: FloatArray, stiffness: float) -> Directions:
    """Return the directions of a likelihood at its optimum.

    Parameters
    ----------
    columns
        (n, K), of the design, over each frame's scale.
    pull
        (n,), slopes of each frame's log density along its scaled mean.
    stiffness
        Mean of their own slopes.
    """
    count = len(pull)
    values, vectors = np.linalg.eigh(stiffness * columns.T @ columns / count)
    good = values > _LEAST * values.max()
    root = np.sqrt(values[good])
    along: FloatArray = vectors[:, good] / root
    across: FloatArray = (vectors[:, good] * root).T
    # All columns have the mean 1, so that the mean frame's cost is the sum of the coefficients.
    turned, _ = np.linalg.qr(np.column_stack([along.sum(axis=0), np.eye(len(root))]))
    along, across = along @ turned, turned.T @ across
    return Directions(along, across, (columns * pull[:, np.newaxis]) @ along)


def stretch_of(
    sample: Sample, design: Design, theta: FloatArray, likelihood: Likelihood
) -> Stretch:
    """Return how the likelihood of a sample is to be stretched about its optimum, `theta`.

    Student's t has its optimum at the core of the frames.  What a frame takes on average is more
    where the machine is slow for a while, so the posterior is moved to the mean of all frames that
    are no spikes; those the simulator draws apart.
    """
    draws = Draws(likelihood.names, theta[np.newaxis], float(sample.time_ms.mean()))
    mean, scale = (moment[0] for moment in draws.moments(design))
    dof = 1.0 / theta[-1] if likelihood.names[-1] == "inverse_dof" else None
    pull, stiffness = pulls((sample.time_ms - mean) / scale, dof)
    found = directions((design.columns / scale).T, pull, stiffness)
    width, whole = len(design.names), len(theta)
    moved = theta.copy()
    away = sample.time_ms - mean
    if dof is not None:
        away = _without_spikes(away, mean, sample.series)
        moved[:width] *= 1.0 + float(away.mean() / mean.mean())
    # Errors as they are, and over the frame's time: a model's are of any size in any frame, a slow
    # machine's are in proportion, and their order drowns in that of long frames.  The larger counts.
    size = 1.0 / float(found.along[:, 0].sum())
    relative = _unexplained(away / mean, (design.columns[1:] / mean).T, sample.series)
    seen = [away * size, relative * size * mean.mean()]
    times, tail = max(
        [_over_logs(np.column_stack([one, found.scores[:, 1:]]), sample.series) for one in seen],
        key=lambda found: found[0][0],
    )
    shrink = np.eye(whole) / np.sqrt(times.mean())
    beyond = np.eye(width) - found.along @ found.across
    shrink[:width, :width] = (found.along / np.sqrt(times)) @ found.across + beyond
    covariance: FloatArray = (found.along * times) @ found.along.T / len(sample)
    value = float(likelihood(theta[np.newaxis])[0])
    return Stretch(theta, moved, value, shrink, tail, times, covariance)


def _without_spikes(away: FloatArray, mean: FloatArray, series: NDArray[np.int64]) -> FloatArray:
    """Return what frames took beyond their mean, (n,), in place of spikes the rest's average."""
    away = away.copy()
    for log in np.unique(series):
        where = np.flatnonzero(series == log)
        spiked = are_spikes(away[where] / mean[where])
        away[where[spiked]] = away[where[~spiked]].mean()
    return away


def _unexplained(
    relative: FloatArray, columns: FloatArray, series: NDArray[np.int64]
) -> FloatArray:
    """Return relative residuals with what columns that change as slowly took of them, (n,).

    A fit to frames whose predictors are slow follows the machine's slow states by chance; a fit to
    their steps does not.
    """
    within = np.flatnonzero(series[1:] == series[:-1])
    before, after = relative[within], relative[within + 1]
    kept = max(0.0, float(before @ after / (relative @ relative)))
    steps = columns[within + 1] - kept * columns[within]
    rise = after - kept * before
    if len(within) <= 2 * steps.shape[1]:
        return relative
    solve: Any = np.linalg.lstsq
    slopes: FloatArray = solve(steps - steps.mean(axis=0), rise - rise.mean(), rcond=1e-9)[0]
    return relative - columns @ slopes


def pulls(z: FloatArray, dof: float | None) -> tuple[FloatArray, float]:
    """Return slopes of the log density at scaled residuals, and the mean of their own slopes.

    Of a normal distribution where `dof` is None, else of Student's t.
    """
    if dof is None:
        return z, 1.0
    pull = (dof + 1.0) * z / (dof + z**2)
    curvature: FloatArray = (dof + 1.0) * (dof - z**2) / (dof + z**2) ** 2
    return pull, max(float(curvature.mean()), _LEAST_STIFF)


def _over_logs(scores: FloatArray, series: NDArray[np.int64]) -> tuple[FloatArray, float]:
    """Return by how much the variance along each direction is larger, (k,), and the t's dof.

    Logs are independent of each other; their parts in the variance are those of their frames.
    """
    parts = [scores[series == log] for log in np.unique(series)]
    first = [slow_error(part[:, 0]) for part in parts]
    variance = np.array([part[:, 0].var() * len(part) for part in parts])
    slow = variance * np.array([error.times for error in first])
    # Satterthwaite: a sum of independent parts is as sure as the largest of them, or surer.
    dof = float(slow.sum() ** 2 / np.sum(slow**2 / np.array([error.dof for error in first])))
    times = np.zeros(scores.shape[1])
    for place in range(scores.shape[1]):
        for part in parts:
            column = part[:, place]
            error: SlowError = slow_error(column, dof)
            times[place] += float(column.var()) * error.times * len(part) / len(scores)
    return np.maximum(times, 1.0), dof
