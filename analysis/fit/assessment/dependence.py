"""How many independent frames a log is worth, and how much wider that makes the posterior.

What a cost model misses changes slowly with the view or the machine, so successive frames err
alike; and no noise is quite Student's t.  A likelihood that multiplies frames as if they were
independent and its noise true is too sure of itself, and not in all directions alike: where views
come in any order, slow errors blur the cost of the mean frame and hardly the difference that a
triangle makes.  So the likelihood is stretched about its optimum, in each direction by what the
scores of the frames say (the curvature adjustment of composite likelihoods: Ribatet, Cooley,
Davison, Statistica Sinica 22, 2012).  The first direction is a common factor of all coefficients:
along it no bound is met, as a slow machine makes nothing cost less than nothing.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import FloatArray
from .slow_error import slow_error
from .spikes import are_spikes

_LEAST_STIFF = 0.1  # mean curvature of a frame's likelihood; outliers' own is negative
_STRETCH, _STRETCHES = 10, 30  # frames of a stretch at most, and how many there must be
_FEW = 30  # frames, of which no mean is more robust than their core
_STANDS_OUT = 2.0  # deviations of chance
_LEAST = 1e-9  # curvature, of the largest, below which a direction is not looked at


@dataclass(frozen=True, slots=True, eq=False)
class Frames:
    """Frames about the optimum of a likelihood, in the order in which they were drawn.

    Attributes
    ----------
    scaled : (K,) float64
        The coefficients there.
    slopes : (K, n) float64
        By how much their times grow with each coefficient.
    mean, scale : (n,) float64
        Mean time and scale of the noise, ms.
    time_ms : (n,) float64
    series : (n,) int64
        Which log a frame is of; logs err independently of each other.
    dof : of Student's t, or None where the noise is Gaussian
    """

    scaled: FloatArray
    slopes: FloatArray
    mean: FloatArray
    scale: FloatArray
    time_ms: FloatArray
    series: NDArray[np.int64]
    dof: float | None

    def rows(self, which: NDArray[np.int64]) -> "Frames":
        """Return some of the frames."""
        one = (self.mean[which], self.scale[which], self.time_ms[which], self.series[which])
        return Frames(self.scaled, self.slopes[:, which], *one, self.dof)


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """What frames tell of K coefficients along k directions in which they are equally stiff.

    Attributes
    ----------
    along : (K, k) float64
        The directions as columns; the first is that of a common factor.
    across : (k, K) float64
        What takes coefficients to their places along each.
    times : (k,) float64
        Variance along each over that of as many independent frames of a true model, at least 1.
    dof : degrees of freedom of the t that a place along a direction is distributed as
    rise : share by which frames without spikes take longer than the optimum says
    """

    along: FloatArray
    across: FloatArray
    times: FloatArray
    dof: float
    rise: float


def dependence(frames: Frames) -> Dependence:
    """Return what frames tell, if they err alike for a while.

    Student's t has its optimum at the core of the frames.  What a frame takes on average is more
    where the machine is slow for a while, hence `rise`; spikes are left out of it, since the
    simulator draws them apart.
    """
    slopes, mean, series = frames.slopes, frames.mean, frames.series
    z = (frames.time_ms - mean) / frames.scale
    pull, stiffness = _pulls(z, frames.dof)
    columns = (slopes / frames.scale).T
    along, across = _directions(columns, stiffness, frames.scaled)
    scores: FloatArray = (columns * pull[:, np.newaxis]) @ along
    size = float(np.linalg.norm(across @ frames.scaled))
    seen, rise = _common_factor(frames)
    times, dof = max(_over_logs(size * one, series) for one in seen)
    others = [_over_logs(column, series, dof)[0] for column in scores.T[1:]]
    return Dependence(along, across, np.maximum([times, *others], 1.0), dof, rise)


def _common_factor(frames: Frames) -> tuple[tuple[FloatArray, ...], float]:
    """Return what each frame says of a common factor, (n,), in several ways, and the rise.

    Gaussian noise, or few frames: the scores themselves.  Else, of the mean of frames without
    spikes, errors as they are, and over the frame's time: a model's are of any size in any frame, a
    slow machine's are in proportion, and their order drowns in that of long frames.
    """
    slopes, mean, series = frames.slopes, frames.mean, frames.series
    away = _without_spikes(frames)
    if frames.dof is None or len(mean) < _FEW:
        weight: FloatArray = (mean / frames.scale) ** 2
        weight /= weight.mean()
        rest = _unexplained(away, slopes.T, series)
        return (away / mean * weight, rest / mean * weight), 0.0
    return (
        away / mean.mean(),
        _unexplained(away, slopes.T, series) / mean.mean(),
        _unexplained(away / mean, (slopes / mean).T, series),
    ), float(away.mean() / mean.mean())


def _pulls(z: FloatArray, dof: float | None) -> tuple[FloatArray, float]:
    """Return slopes of the log density at scaled residuals, and the mean of their own slopes."""
    if dof is None:
        return z, 1.0
    pull = (dof + 1.0) * z / (dof + z**2)
    curvature: FloatArray = (dof + 1.0) * (dof - z**2) / (dof + z**2) ** 2
    return pull, max(float(curvature.mean()), _LEAST_STIFF)


def _directions(
    columns: FloatArray, stiffness: float, scaled: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return directions of equal curvature, (K, k), and their inverse, (k, K)."""
    values, vectors = np.linalg.eigh(stiffness * columns.T @ columns / len(columns))
    good = values > _LEAST * values.max()
    root = np.sqrt(values[good])
    along: FloatArray = vectors[:, good] / root
    across: FloatArray = (vectors[:, good] * root).T
    turned, _ = np.linalg.qr(np.column_stack([across @ scaled, np.eye(len(root))]))
    return along @ turned, turned.T @ across


def rise_of(frames: Frames) -> float:
    """Return the share by which frames take longer than their means on average, spikes aside."""
    if len(frames.mean) < _FEW:
        return 0.0
    return float(_without_spikes(frames).mean() / frames.mean.mean())


def _without_spikes(frames: Frames) -> FloatArray:
    """Return what frames took beyond their mean, (n,), in place of spikes the rest's average.

    Gaussian noise has no spikes: there the mean of all frames is what is fitted.
    """
    away = frames.time_ms - frames.mean
    for log in np.unique(frames.series) if frames.dof is not None else ():
        where = np.flatnonzero(frames.series == log)
        spiked = are_spikes(away[where] / frames.mean[where])
        away[where[spiked]] = away[where[~spiked]].mean()
    return away


def _unexplained(errors: FloatArray, columns: FloatArray, series: NDArray[np.int64]) -> FloatArray:
    """Return errors, (n,), with what columns, (n, K), that change as slowly took of them.

    A fit to frames whose predictors are slow follows the machine's slow states by chance; a fit to
    the steps between stretches of frames does not.
    """
    size = min(_STRETCH, len(errors) // _STRETCHES)
    if size < 1:
        return errors
    whole = len(errors) // size * size
    steps = np.column_stack([columns, errors])[:whole].reshape(-1, size, columns.shape[1] + 1)
    steps = steps.mean(axis=1)
    of_log = series[:whole:size]
    within = np.flatnonzero(of_log[1:] == of_log[:-1])
    before, after = steps[within], steps[within + 1]
    kept = float(before[:, -1] @ after[:, -1] / (before[:, -1] @ before[:, -1] + 1e-300))
    if kept < _STANDS_OUT / np.sqrt(len(within)):
        return errors
    steps = after - kept * before
    steps -= steps.mean(axis=0)
    solve: Any = np.linalg.lstsq
    slopes: FloatArray = solve(steps[:, :-1], steps[:, -1], rcond=1e-9)[0]
    return errors - columns @ slopes


def _over_logs(
    scores: FloatArray, series: NDArray[np.int64], dof: float | None = None
) -> tuple[float, float]:
    """Return the variance of a mean of scores over that of n of mean square 1, and the t's dof."""
    parts = [scores[series == log] for log in np.unique(series)]
    errors = [slow_error(part, dof) for part in parts]
    variance = np.array(
        [
            float(part.var()) * error.times * len(part) / len(scores)
            for part, error in zip(parts, errors, strict=True)
        ]
    )
    # Satterthwaite: a sum of independent parts is as sure as the largest of them, or surer.
    each = np.array([error.dof for error in errors])
    total = float(variance.sum())
    return total, total**2 / float(np.sum(variance**2 / each) + 1e-300)
