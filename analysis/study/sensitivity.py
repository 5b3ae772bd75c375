"""How much of a metric's variance each axis of a study explains by itself: first-order indices.

After I. M. Sobol', Sensitivity estimates for nonlinear mathematical models, 1993: of a metric Y
over a grid of axes, each value as often as the others, S_i = Var(E[Y | X_i]) / Var(Y).  The rest up
to 1 is what axes do together, and the noise of seeds, which is in Var(Y) and has its own share.

A mean over runs holds noise, which would pass for an effect.  Where seeds repeat every combination,
squares of an effect are taken as products of its estimates under two different seeds: what these
have in common is the effect alone, so that the estimate has no bias, however few the runs, and also
where seeds are common to all combinations.  Intervals resample the seeds.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray

LEVEL = 0.9
FEWEST_SEEDS = 4
"""For an interval; that of fewer would be a guess."""
_RESAMPLES = 2000


@dataclass(frozen=True, slots=True)
class Share:
    """Part of a variance.

    Attributes
    ----------
    value : float
        Unbiased where there are two seeds or more, so that it may be below 0 where nothing is.
    low, high : float or None
        Ends of the interval of `LEVEL` over seeds; None where there are fewer than `FEWEST_SEEDS`.
    """

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Shares:
    """Split of the variance of one metric.

    Attributes
    ----------
    variance : float
        Of a run, over combinations and seeds.
    axes : tuple of Share
        What each axis explains by itself, in the order of the axes.
    together : Share
        What combinations explain beyond that: interactions.
    noise : Share or None
        What differs between the seeds of a combination; None where there is one seed.
    """

    variance: float
    axes: tuple[Share, ...]
    together: Share
    noise: Share | None


def split_variance(values: FloatArray) -> Shares | None:
    """Split the variance of a metric over a full grid; None if it does not vary.

    Parameters
    ----------
    values : (n_1, ..., n_k, seeds) float64
        Of a run, by the value of each axis and its seed.
    """
    seeds = values.shape[-1]
    if not np.ptp(values) > 1e-12 * np.abs(values).max():  # what rounding leaves is no variance
        return None
    pairs = _pairs(values - values.mean())
    weights = np.ones((1, seeds))
    variances = _means_of_pairs(pairs, weights)[0]
    total = variances[-1]
    if not total > 0.0:
        return None
    ends = _interval(pairs, variances / total) if seeds >= FEWEST_SEEDS else None
    shares = [
        Share(float(variance / total), *(() if ends is None else ends[:, at].tolist()))
        for at, variance in enumerate(variances[:-1])
    ]
    *axes, together, noise = shares
    return Shares(float(total), tuple(axes), together, noise if seeds > 1 else None)


def _pairs(values: FloatArray) -> FloatArray:
    """Return by part of the variance what each two seeds say of it, (parts, seeds, seeds).

    Parts are the main effects, what is together, the noise, and the sum of all.
    """
    effects = [_product(_centred(_over_others(values, axis))) for axis in range(values.ndim - 1)]
    flat = values.reshape(-1, values.shape[-1])
    cells = _product(_centred(flat))
    raw = _product(flat)
    # Half the squared difference of two runs of a combination, whose mean is its variance.
    noise = 0.5 * np.add.outer(np.diag(raw), np.diag(raw)) - raw
    return np.stack([*effects, cells - np.sum(effects, axis=0), noise, cells + noise])


def _over_others(values: FloatArray, axis: int) -> FloatArray:
    """Return the mean over all axes but one and the seeds, (values of the axis, seeds)."""
    others = tuple(other for other in range(values.ndim - 1) if other != axis)
    return values.mean(axis=others)


def _centred(effects: FloatArray) -> FloatArray:
    return effects - effects.mean(axis=0)


def _product(effects: FloatArray) -> FloatArray:
    """Return the mean over rows of the products of columns, (seeds, seeds)."""
    return effects.T @ effects / len(effects)


def _means_of_pairs(pairs: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the weighted means over pairs of different seeds, (draws, parts).

    With one seed there is no such pair, and what it says of itself stands.
    """
    seeds = pairs.shape[-1]
    apart = 1.0 - np.eye(seeds) if seeds > 1 else np.ones((1, 1))
    # A product of matrices a part: one sum over all indices at once is a hundred times as slow.
    sums = [((weights @ part) * weights).sum(axis=1) for part in (*(pairs * apart), apart)]
    return np.stack(sums[:-1], axis=1) / sums[-1][:, np.newaxis]


def _interval(pairs: FloatArray, shares: FloatArray) -> FloatArray:
    """Return the ends of the interval of each share, (2, parts), from resampled seeds."""
    from scipy.stats import norm, t

    seeds = pairs.shape[-1]
    draws = np.random.default_rng(seeds).multinomial(seeds, np.full(seeds, 1 / seeds), _RESAMPLES)
    draws = draws[np.count_nonzero(draws, axis=1) > 1]  # one seed alone has no pairs
    variances = _means_of_pairs(pairs, draws.astype(np.float64))
    resampled = variances / variances[:, -1:]
    tail = 0.5 - 0.5 * LEVEL
    ends: FloatArray = np.quantile(resampled, (tail, 1.0 - tail), axis=0)
    # The bootstrap of n values has n - 1 in place of n in its variance, and the tails of a normal
    # distribution where Student's are wider.  With both, 4 to 16 seeds cover as they should.
    student = float(t.ppf(1.0 - tail, seeds - 1)) / float(norm.ppf(1.0 - tail))
    ends = shares + (ends - shares) * np.sqrt(seeds / (seeds - 1)) * student
    return ends.clip(0.0, 1.0)  # where shares lie, though not their estimates
