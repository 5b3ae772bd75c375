"""Whether a mean over such paths is within a limit: what a promise needs beyond Student's t.

A metric that is never negative is judged on its logarithm, as `intervals.such_paths` has it.  A
share of time is nothing on many paths, where t on n values takes no miss on n paths for none at
all: it is judged in two parts, (share of paths with any) × (share given any).  With a miss on one
path or none, nothing tells how much another such path would miss: then it counts as missed whole,
and only the number of paths speaks (Clopper and Pearson).
"""

from math import ceil, log, log1p

import numpy as np
from scipy.special import betaincinv, stdtr

from ...base.arrays import FloatArray
from .intervals import such_paths
from .metric_kinds import Kind
from .paired import FAIL_ALPHA, PASS_LEVEL, Evidence, by_t, needed_replicates

_QUANTILES = (np.arange(1 << 15) + 0.5) / (1 << 15)  # of the share of paths, for p down to .0001


def at_most(
    values: FloatArray,
    kind: Kind,
    limit: float,
    alpha: float = FAIL_ALPHA,
    level: float = PASS_LEVEL,
) -> Evidence:
    """Return what n paths say of whether the mean over such paths is at most a limit.

    Parameters
    ----------
    values : (n,) float64
        The metric on n paths, two or more, each the mean over its seeds.
    kind : one of `Kind`
        No extreme.
    """
    beyond = values - limit
    some = values[values > 0]
    if kind == "signed" or (kind == "positive" and not len(some)) or limit < 0.0:
        return by_t(beyond, alpha, level)
    if kind == "share" and len(some) < 2:
        return _hardly_any(len(values), len(some), float(beyond.mean()), limit, level)
    found = such_paths(values, kind, 2.0 * level - 1.0)
    assert found is not None, "an extreme has no mean"
    # One path with any shows no spread of how much: nothing then tells how much others have.
    high = found.high - limit if len(some) > 1 else np.inf
    return Evidence(
        p=_p(values, some, 1.0 if kind == "share" else np.inf, limit),
        excess=float(beyond.mean()),
        high=float(high),
        needed=needed_replicates(beyond, 0.0, alpha, level),
    )


def _p(values: FloatArray, some: FloatArray, most: float, limit: float) -> float:
    """Return the p that the mean is within the limit: its confidence of being there."""
    n, k = len(values), len(some)
    if k < 2:
        return float("nan")
    squared = float(some.var(ddof=1) / some.mean() ** 2)
    error = float(np.sqrt((squared + squared**2 / 2) / k))  # as in `such_paths`
    everywhere = k == n and most == np.inf
    share = np.ones(1) if everywhere else betaincinv(k + 0.5, n - k + 0.5, _QUANTILES)
    room = limit / share  # what the mean of the paths with any may be
    if error == 0.0:
        within = (some.mean() <= room).astype(np.float64)
    else:
        with np.errstate(divide="ignore"):  # no room at all: certainly beyond
            within = stdtr(k - 1, np.log(room / some.mean()) / error)
    return float(np.where(room >= most, 1.0, within).mean())


def _hardly_any(n: int, k: int, excess: float, limit: float, level: float) -> Evidence:
    """Return what is known of a share of time when a path or none of n has any."""
    high = float(betaincinv(k + 1, n - k, level)) if k < n else 1.0
    needed = None
    if k == 0 and 0.0 < limit < 1.0:
        needed = ceil(log(1.0 - level) / log1p(-limit))
    return Evidence(float("nan"), excess, high - limit, needed)
