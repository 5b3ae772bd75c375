"""Intervals of a metric's mean, each with the population that it is of.

*This path*: the same paths under other noise.  *Such paths*: other paths of the kind.  *With the
machine*: such paths on a machine whose costs are as uncertain as the profile says.  All are two-
sided, with 5 % beyond each end unless `level` says otherwise.
"""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from scipy.special import betaincinv, stdtrit

from ...base.arrays import FloatArray
from .metric_kinds import Kind

_SKEW_COST = 4.0
"""Paths that a squared coefficient of variation, or a squared skewness, of 1 costs.

Set so that intervals of log-normal, exponential and gamma values called `enough` cover at least
.87 of nominal .9; a stricter rule would cover less, as samples that missed their tail pass it."""

_FEWEST = 4  # paths, or values above 0, from which a spread is estimated
_ROUNDING = 1e-6  # relative difference that is none: refreshes end at whole nanoseconds
_TO_THE_SIDE = 0.2  # mean share, below which shares lean to one side as other positive values do
_GRID = (np.arange(64) + 0.5) / 64  # quantiles that stand for a distribution


@dataclass(frozen=True, slots=True)
class Interval:
    """Where a mean lies.

    Attributes
    ----------
    low, high : float
        nan where there are too few replicates for any interval.
    enough : bool
        Whether the replicates are many enough, for how skewed they are, to cover as stated.
    needed : int or None
        Replicates that would do, if they are not enough; None also where no number can be told.
    """

    low: float
    high: float
    enough: bool
    needed: int | None


def this_path(values: FloatArray, level: float = 0.9) -> Interval:
    """Return the interval of the mean over these very paths, under other noise.

    Noise may differ from path to path: degrees of freedom are Welch's.  `needed` counts seeds.

    Source: Welch, Biometrika 34 (1947), with f + 2 for f, which estimates the degrees without bias
    for normal noise.

    Parameters
    ----------
    values : (n, S) float64
        On n paths, with S seeds each.
    """
    n, seeds = values.shape
    needed = 1 + ceil(3 / n)  # three degrees of freedom, below which t is wider than it is useful
    if seeds < 2:
        return Interval(float("nan"), float("nan"), enough=False, needed=needed)
    mean = float(values.mean())
    error: FloatArray = values.var(axis=1, ddof=1) / seeds
    degrees = welch_degrees(error, seeds - 1.0)
    half = float(stdtrit(degrees, (1 + level) / 2) * np.sqrt(error.sum())) / n
    enough = seeds >= needed
    return Interval(mean - half, mean + half, enough=enough, needed=None if enough else needed)


def such_paths(values: FloatArray, kind: Kind, level: float = 0.9) -> Interval | None:
    """Return the interval of the mean over such paths, or None for an extreme, which has none.

    "signed": Student's t.  "positive": t on the logarithm of the mean, which reaches further up
    than down.  "share", and "positive" with zeros among them: the share of paths with any (beta;
    exact if no path has) times the mean of those (t on its logarithm), at most 1 for a share; of
    shares nearer 1, what is missing to it; of shares about a half Student's t.  "capped": what is
    missing to the best of the paths, as such a share of it, where most have that; else as
    "positive".  Paths that are all alike are not enough, but of a share or a rate: how far another
    may be from them, none tells.
    Of one path there is none: nan.  `needed` counts paths.

    Parameters
    ----------
    values : (n,) float64
        The metric on n paths, each the mean over its seeds; not negative unless "signed".
    kind : one of `Kind`
        As `kind_of` tells it.
    """
    if kind == "extreme":
        return None
    if len(values) < 2:
        return Interval(float("nan"), float("nan"), enough=False, needed=_FEWEST)
    if kind == "capped" and _is_capped(values):
        best = float(values.max())
        missing = _of_two_parts(1.0 - values / best, 1.0, level)
        return replace(missing, low=best * (1.0 - missing.high), high=best * (1.0 - missing.low))
    if kind == "share":
        return _of_share(values, level)
    if kind != "signed" and not (values > 0).all():
        return _of_two_parts(values, np.inf, level)
    found = _of_signed(values, level)
    return replace(found, enough=False, needed=None) if _are_alike(values) else found


def with_machine(
    values: FloatArray, over_draws: FloatArray, kind: Kind, level: float = 0.9
) -> Interval | None:
    """Return the interval over such paths on another machine of the posterior.

    The machine's part is the predictive t interval of the draws' means about their own mean: as
    factors where all are positive, else as differences.  Both parts are joined by the squares of
    what they reach to either side (MOVER: Zou and Donner, Statistics in Medicine 27, 2008), the
    path's variance over n and the machine's whole: more paths do not make a machine known.
    `needed` counts paths if those are too few, else draws.

    Parameters
    ----------
    values : (n,) float64
        On n paths, on the machine as fitted.
    over_draws : (D, J) float64
        On the same few paths, the columns, on D draws of the machine.
    """
    paths = such_paths(values, kind, level)
    if paths is None:
        return None
    draws = len(over_draws)
    if draws < 2:
        return Interval(float("nan"), float("nan"), enough=False, needed=_FEWEST)
    mean, of_draw = float(values.mean()), over_draws.mean(axis=1)
    as_factors = kind == "positive" and bool(paths.low > 0 and (of_draw > 0).all())
    machine = np.log(of_draw) if as_factors else of_draw
    reach = float(stdtrit(draws - 1, (1 + level) / 2) * machine.std(ddof=1))
    reach *= np.sqrt(1 + 1 / draws)
    if as_factors:
        low = mean * np.exp(-np.hypot(np.log(mean / paths.low), reach))
        high = mean * np.exp(np.hypot(np.log(paths.high / mean), reach))
    else:
        low, high = (
            mean - np.hypot(mean - paths.low, reach),
            mean + np.hypot(paths.high - mean, reach),
        )
        low = low if kind == "signed" else max(low, 0.0)
        high = min(high, 1.0) if kind == "share" else high
    needed = paths.needed if not paths.enough else None if draws >= _FEWEST else _FEWEST
    enough = paths.enough and draws >= _FEWEST
    return Interval(float(low), float(high), enough=enough, needed=needed)


def _is_capped(values: FloatArray) -> bool:
    """Return whether at least half of the rates are the best of them, as the display's are.

    Where the machine and not the display bounds a rate, no path shows what others may reach.
    """
    best = float(values.max())
    return best > 0.0 and 2 * int((values >= best * (1.0 - _ROUNDING)).sum()) >= len(values)


def _are_alike(values: FloatArray) -> bool:
    return bool(np.ptp(values) <= _ROUNDING * np.abs(values).max())


def _of_signed(values: FloatArray, level: float) -> Interval:
    """Return Student's interval, or that of positive values, turned if need be, of one sign.

    How many are enough for Student's is judged by their skewness.
    """
    if (values > 0).all():
        return _of_positive(values, level)
    if (values < 0).all():
        turned = _of_positive(-values, level)
        return replace(turned, low=-turned.high, high=-turned.low)
    n, mean, sd = len(values), float(values.mean()), float(values.std(ddof=1))
    half = float(stdtrit(n - 1, (1 + level) / 2)) * sd / np.sqrt(n)
    deviation = values - mean
    moment = float((deviation**2).mean())
    skewness = float((deviation**3).mean()) / moment**1.5 if moment > 0 else 0.0
    # Symmetric values have a squared skewness of 6 / n by chance.
    return _judged(mean - half, mean + half, n, max(skewness**2 - 6 / n, 0.0))


def _of_positive(values: FloatArray, level: float) -> Interval:
    """Return t's interval on the logarithm of the mean of positive values."""
    n, mean = len(values), float(values.mean())
    squared, error = relative_spread(values)
    reach = float(stdtrit(n - 1, (1 + level) / 2)) * error
    return _judged(mean * np.exp(-reach), mean * np.exp(reach), n, squared)


def _of_share(values: FloatArray, level: float) -> Interval:
    """Return the interval of the mean of shares, within [0, 1].

    Two parts hold near 0, and near 1 of what is missing.  Between, where no path is at either end,
    they would lean to one side: their share of paths with any is less than all of them.
    """
    mean, missing = float(values.mean()), 1.0 - values
    missing[missing <= _ROUNDING] = 0.0
    within = values.min() > 0.0 and missing.min() > 0.0
    if within and _TO_THE_SIDE < mean < 1.0 - _TO_THE_SIDE and not _are_alike(values):
        found = _of_signed(values, level)
        return replace(found, low=max(found.low, 0.0), high=min(found.high, 1.0))
    if mean <= 0.5:
        return _of_two_parts(values, 1.0, level)
    found = _of_two_parts(missing, 1.0, level)
    return replace(found, low=1.0 - found.high, high=1.0 - found.low)


def _of_two_parts(values: FloatArray, most: float, level: float) -> Interval:
    """Return the interval of (share of paths with any) × (mean of those), a product of quantiles.

    Jeffreys' beta for the first, as exact bounds would count the doubt twice; where no path has
    any, the exact bound times the `most` that a path can have.  One path with any shows no spread:
    it is taken as varying by its own size.  A share's interval covers from few such paths too, as
    it is wide then and ends at 1; an unbounded one does not.
    """
    n, some = len(values), values[values > 0]
    k = len(some)
    tail = (1 - level) / 2
    if not k:
        if not np.isfinite(most):  # nothing tells how much a path with any would have
            return Interval(0.0, 0.0, enough=False, needed=None)
        return Interval(0.0, most * float(betaincinv(1, n, 1 - tail)), enough=True, needed=None)
    squared, error = relative_spread(some) if k > 1 else (1.0, 1.0)
    of_some = float(some.mean()) * np.exp(stdtrit(max(k - 1, 1), _GRID) * error)
    share = betaincinv(k + 0.5, n - k + 0.5, _GRID)
    low, high = np.quantile(np.outer(share, np.minimum(of_some, most)), [tail, 1 - tail])
    if np.isfinite(most) and k < _FEWEST:
        return _judged(low, high, n, 0.0)
    found = _judged(low, high, k, squared)
    needed = None if found.needed is None else ceil(found.needed * n / k)
    return replace(found, needed=needed)


def relative_spread(values: FloatArray) -> tuple[float, float]:
    """Return the squared coefficient of variation, and the standard error of the mean's logarithm.

    Half of the fourth power is added to the square: what a skewed sample's own variance misses.
    """
    squared = float(values.var(ddof=1) / values.mean() ** 2)
    return squared, float(np.sqrt((squared + squared**2 / 2) / len(values)))


def _judged(low: float, high: float, n: int, skew: float) -> Interval:
    """Return the interval with whether n values of this squared skew are enough."""
    needed = ceil(_FEWEST + _SKEW_COST * skew - 0.5)
    enough = n >= needed
    return Interval(float(low), float(high), enough=enough, needed=None if enough else needed)


def welch_degrees(errors: FloatArray, each: float) -> float:
    """Return Welch's degrees of freedom of a sum of variances, (n,), of `each` degrees.

    They are between those of one of the variances and those of all together, where the estimate,
    which is free of bias in the mean, may go beyond either.
    """
    most = each * len(errors)
    squares = float((errors**2).sum()) / (each + 2)
    if squares == 0:
        return most
    return min(max(float(errors.sum()) ** 2 / squares - 2, each), most)
