"""Whether a policy keeps the budget on paths of a kind, judged from some of them.

A policy keeps a path if the p99 over time of ``work_ms`` there is within the budget.  Ratios of
p99 to budget are taken as log-normal over paths, so that the chance that another path is kept is
the predictive one of a normal sample (Student's t): it covers both how paths differ and how little
is known of that from n of them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv, stdtr

from ...base.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Keeping:
    """How surely the budget is kept.

    Attributes
    ----------
    probability : float
        That another path of the kind is kept; nan from one path, which shows no spread.
    kept, paths : int
        Paths that were kept, of how many.
    low, high : float
        Exact bounds of the share of such paths that are kept, whatever their distribution.
    """

    probability: float
    kept: int
    paths: int
    low: float
    high: float


def keeping(p99_ms: FloatArray, budget_ms: float, level: float = 0.9) -> Keeping:
    """Return how surely the budget is kept, from the p99 of ``work_ms`` on n paths, (n,)."""
    kept = int((p99_ms <= budget_ms).sum())
    low, high = exact_bound(kept, len(p99_ms), level)
    return Keeping(p_keeps(p99_ms, budget_ms), kept, len(p99_ms), low, high)


def p_keeps(p99_ms: FloatArray, budget_ms: float) -> float:
    """Return the predictive probability that another path of the kind is kept.

    Parameters
    ----------
    p99_ms : (n,) float64
        Positive; of one policy on n paths.  From one path the answer is nan.
    """
    return float(predictive_probability(np.log(p99_ms / budget_ms)))


def p_keeps_with_machine(p99_ms: FloatArray, drawn_ms: FloatArray, budget_ms: float) -> float:
    """Return the probability that another path is kept on another machine of the draws.

    Each draw shifts the logarithm of the time of all paths by as much as on those that it was
    replayed on; draws cover what is not known of the machine, so that the probability is their
    mean.  A policy that steers hardly shifts, one that does not steer shifts as its machine does.

    Parameters
    ----------
    p99_ms : (n,) float64
        As of `p_keeps`, on the machine as fitted.
    drawn_ms : (D, J) float64
        On the same few paths, the columns, on D draws of the machine.
    """
    of_draw = np.log(drawn_ms).mean(axis=1)
    shift = (of_draw - of_draw.mean())[:, np.newaxis]
    return float(predictive_probability(np.log(p99_ms / budget_ms) + shift).mean())


def predictive_probability(values: FloatArray, known: int | None = None) -> FloatArray:
    """Return the probability that one more value is at most 0, of normal samples, (…, n) to (…).

    The new value less the mean of n has n + 1 n-ths of the variance, estimated with n − 1 degrees
    of freedom: exact for normal values.  Samples of equal values give 0 or 1; of one value, nan.
    Where these are some of `known` values, mean and variance stand for theirs.

    Source: Geisser, Predictive Inference (1993), section 2.2.
    """
    n = max(values.shape[-1], known or 0)
    mean = values.mean(axis=-1)
    if values.shape[-1] < 2:
        return np.full_like(mean, np.nan)
    sd = values.std(axis=-1, ddof=1)
    spread = np.ptp(values, axis=-1) > 0
    t: FloatArray = -mean / np.where(spread, sd * np.sqrt(1 + 1 / n), 1.0)
    # The mean of equal values may differ from them by rounding; one of them does not.
    return np.where(spread, stdtr(n - 1, t), np.where(values[..., 0] <= 0, 1.0, 0.0))


def exact_bound(kept: int, n: int, level: float = 0.9) -> tuple[float, float]:
    """Return the bounds of a share of which `kept` of n were seen; each side errs (1 − level) / 2.

    Source: Clopper and Pearson, Biometrika 26 (1934).
    """
    tail = (1 - level) / 2
    low = float(betaincinv(kept, n - kept + 1, tail)) if kept else 0.0
    high = float(betaincinv(kept + 1, n - kept, 1 - tail)) if kept < n else 1.0
    return low, high
