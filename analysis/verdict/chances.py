"""How probable it is that a policy is the best, and what choosing it would cost.

The joint posterior of P means, given n paths that all policies share, is a multivariate t whose
scatter is that of the paths: policies that rise and fall together stay together, so that small
paired differences are told from large common ones.  A draw is the means plus the centred data
times normal weights, which never needs the P × P covariance.  The chance of being the best is taken
from leads that are shrunk: of many equals one is always in front.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .criterion import Criterion, beyond_margin
from .shrinkage import shrink


@dataclass(frozen=True, slots=True, eq=False)
class Chances:
    """Of each of P policies.

    Attributes
    ----------
    p_best : (P,) float64
        Probability of the best mean over such paths; identical policies share it, so it adds to 1.
    p_within_margin : (P,) float64
        Probability of a mean within the margin of the best.
    regret : (P,) float64
        Expected amount by which its mean is worse than the best, in the metric's unit.
    """

    p_best: FloatArray
    p_within_margin: FloatArray
    regret: FloatArray


def chances(criterion: Criterion, draws: int = 4000, seed: int = 0, spread: float = 1.0) -> Chances:
    """Return each policy's chances in one metric; nan from one path.

    `spread` is the factor on the spread of paths, see `tuning_spread`.

    Source: Geisser and Cornfield, Journal of the Royal Statistical Society B 25 (1963), for the
    posterior; Chick and Inoue, Operations Research 49 (2001), for expected regret.
    """
    policies, n = criterion.values.shape
    if n < 2:
        nothing = np.full(policies, np.nan)
        return Chances(nothing, nothing, nothing)
    # Shrunk means would be too sure that all are near the best; plain ones, that one is the best.
    leads = _posterior([criterion], draws, seed, spread, shrunk=True)[0]
    sampled = _posterior([criterion], draws, seed, spread, shrunk=False)[0]
    best = sampled.min(axis=1, keepdims=True)
    within = beyond_margin(sampled, best, criterion) <= 0
    return Chances(
        p_best=_shared(leads == leads.min(axis=1, keepdims=True)),
        p_within_margin=within.mean(axis=0),
        regret=(sampled - best).mean(axis=0),
    )


def order_chances(
    criteria: Sequence[Criterion],
    draws: int = 4000,
    seed: int = 0,
    regret_in: str = "",
    spread: float = 1.0,
) -> Chances:
    """Return each policy's chances in the order of the criteria; nan from one path.

    In a draw, who is within the margin of the best in one criterion is judged by the next.  The
    best is who is left with the best mean of the last; within the margin is who is left by its
    margin too.  The regret is that of the criterion `regret_in`, else of the first.  `spread` is as
    in `chances`.
    """
    policies, n = criteria[0].values.shape
    if n < 2:
        nothing = np.full(policies, np.nan)
        return Chances(nothing, nothing, nothing)
    sampled = _posterior(criteria, draws, seed, spread, shrunk=True)
    left: BoolArray = np.ones((draws, policies), dtype=np.bool_)
    best = left
    for criterion, means in zip(criteria, sampled, strict=True):
        least = np.where(left, means, np.inf).min(axis=1, keepdims=True)
        best = left & (means == least)
        left = left & (beyond_margin(means, least, criterion) <= 0)
    names = [criterion.name for criterion in criteria]
    means = sampled[names.index(regret_in) if regret_in in names else 0]
    regret = means - means.min(axis=1, keepdims=True)
    return Chances(_shared(best), left.mean(axis=0), regret.mean(axis=0))


def tuning_spread(turns: int) -> float:
    """Return by what factor means of tuned policies vary more than their paths let them seem.

    The knobs of J turns are tuned on sets that share most of their paths, so that what is measured
    in one turn goes with what is in the others: the variance of the mean is 1 + J / (J − 1) times
    that of independent paths.

    Source: Nadeau and Bengio, Inference for the generalization error, Machine Learning 52 (2003).
    """
    return float(np.sqrt(1.0 + turns / (turns - 1.0)))


def _posterior(
    criteria: Sequence[Criterion], draws: int, seed: int, spread: float, *, shrunk: bool
) -> list[FloatArray]:
    """Return draws of the P means in each criterion, (R, P), turned so that less is better.

    All criteria take the same weights, so that they stay together too.  `shrunk`: with leads taken
    back as far as the leader was chosen for them.
    """
    n = criteria[0].values.shape[1]
    rng = np.random.default_rng(seed)
    weights = rng.standard_normal((draws, n))
    weights -= weights.mean(axis=1, keepdims=True)  # a constant adds nothing, but rounding
    weights /= np.sqrt(n * rng.chisquare(n - 1, (draws, 1)))
    sampled: list[FloatArray] = []
    for criterion in criteria:
        values = criterion.turned()
        if spread != 1.0:
            mean = values.mean(axis=1, keepdims=True)
            values = mean + spread * (values - mean)
        assert values.shape == criteria[0].values.shape
        # Identical policies are sampled once: a matrix product may round equal rows differently.
        rows, of_row = np.unique(values, axis=0, return_inverse=True)
        means = rows.mean(axis=1) + weights @ (rows - rows.mean(axis=1, keepdims=True)).T
        if shrunk:
            means = shrink(means, rows, rng)
        sampled.append(means[:, of_row.reshape(-1)])
    return sampled


def _shared(best: BoolArray) -> FloatArray:
    """Return how often each policy is best, (P,), where those of a draw, (R, P), share it."""
    return (best / best.sum(axis=1, keepdims=True)).mean(axis=0)
