"""How far the mean of successive errors may be from nothing, if errors are alike for a while.

Errors are taken as white noise and an autoregression that forgets in `τ` frames, mixed in a share
`φ`.  Neither is known, and where `τ` is not small beside the log, hardly anything is: so the mean
is not given one long-run variance but one for each (τ, φ), weighed by what the errors say of it.
Their cosine transform has independent coefficients of the variance of the spectrum (Whittle, "Curve
and periodogram smoothing", JRSS B 19, 1957); the level of the spectrum is integrated out under
Jeffreys' prior.  Such a mixture of normal distributions has heavy tails where few stretches of
errors were seen, as the t quantiles of fixed-bandwidth inference have (Lazarus, Lewis, Stock,
Watson, "HAR inference", J. Business & Economic Statistics 36, 2018), but it does not need the
bandwidth.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ....base.arrays import FloatArray

_MOST = 2_000  # coefficients of the lowest frequencies; a mean does not depend on the others
_TIMES, _SHARES = 40, 16  # of the grid of τ and φ: fine enough for thousands of errors
_FASTEST = 0.5  # frames
_WHITE = 0.5  # probability, beforehand, that errors are white
_LEAST_DOF, _MOST_DOF = 4.0, 200.0  # heavier tails than that make no chain that mixes
_FEWEST = 30  # errors, below which nothing can be said of their order


@dataclass(frozen=True, slots=True)
class SlowError:
    """The distribution of a mean of errors, as Student's t with the same 75 and 95 % points.

    Attributes
    ----------
    times : variance over that of as many independent errors, of the t's scale
    dof : degrees of freedom
    """

    times: float
    dof: float


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """Spectra of G mixtures at m frequencies, their variance of the mean, and log prior weights."""

    log_spectrum: FloatArray
    inverse: FloatArray
    of_mean: FloatArray
    log_prior: FloatArray


def slow_error(errors: FloatArray, dof: float | None = None) -> SlowError:
    """Return what is to be said of the mean of n successive errors, (n,).

    Parameters
    ----------
    dof
        Degrees of freedom to state it with; None for those that fit.
    """
    from scipy import stats
    from scipy.fft import dct

    count = len(errors)
    variance = float(errors.var())
    if count < _FEWEST or variance <= 0.0:
        return SlowError(1.0, _MOST_DOF)
    grid = _grid(count)
    transformed: Any = dct(errors, norm="ortho")
    power: FloatArray = np.asarray(transformed, dtype=np.float64)[1 : _MOST + 1] ** 2
    level: FloatArray = grid.inverse @ power / len(power)
    log_weight = -0.5 * (grid.log_spectrum + len(power) * np.log(level)) + grid.log_prior
    weight: FloatArray = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    spread = np.sqrt(level * grid.of_mean / variance)
    half, ends = _points(weight, spread, (0.75, 0.95))
    if dof is None:
        dof = _dof_of(ends / half)
    quantile: Any = stats.t.ppf(0.95, dof)
    return SlowError(float(ends / quantile) ** 2, dof)


def _points(weight: FloatArray, spread: FloatArray, levels: tuple[float, ...]) -> list[float]:
    """Return quantiles of a mixture of centred normal distributions, by bisection."""
    from scipy.special import ndtr

    found: list[float] = []
    for level in levels:
        low, high = 0.0, 10.0 * float(spread.max())
        for _ in range(50):
            middle = 0.5 * (low + high)
            if float(weight @ np.asarray(ndtr(middle / spread))) < level:
                low = middle
            else:
                high = middle
        found.append(high)
    return found


@lru_cache(maxsize=1)
def _ratios() -> tuple[FloatArray, FloatArray]:
    """Return degrees of freedom, falling, and the ratio of t's 95 and 75 % points, rising."""
    from scipy import stats

    dof = np.geomspace(_MOST_DOF, _LEAST_DOF, 60)
    ends: Any = stats.t.ppf(0.95, dof)
    half: Any = stats.t.ppf(0.75, dof)
    return dof, np.asarray(ends / half, dtype=np.float64)


def _dof_of(ratio: float) -> float:
    dof, ratios = _ratios()
    return float(np.interp(ratio, ratios, dof))


@lru_cache(maxsize=6)
def _grid(count: int) -> _Grid:
    """Return the spectra for n errors: white ones first, then each τ with each φ."""
    times = np.geomspace(_FASTEST, 0.5 * count, _TIMES)
    shares: FloatArray = 1.0 / (1.0 + np.exp(-np.linspace(-6.0, 5.0, _SHARES)))
    ahead = np.arange(1, count)
    cosine = np.cos(np.pi * np.arange(1, min(count, _MOST + 1)) / count)
    spectra, of_mean = [np.ones(len(cosine))], [1.0]
    for time in times.tolist():
        keeps = np.exp(-1.0 / time)
        slow = (1.0 - keeps**2) / (1.0 - 2.0 * keeps * cosine + keeps**2)
        # The variance of a mean of n and not the spectrum at 0, which τ beside n leaves open.
        together = 1.0 + 2.0 * float((1.0 - ahead / count) @ keeps**ahead)
        spectra += [1.0 - share + share * slow for share in shares]
        of_mean += [1.0 - share + share * together for share in shares.tolist()]
    spectrum = np.stack(spectra)
    prior = np.full(len(spectra), (1.0 - _WHITE) / (len(spectra) - 1))
    prior[0] = _WHITE
    return _Grid(np.log(spectrum).sum(axis=1), 1.0 / spectrum, np.array(of_mean), np.log(prior))
