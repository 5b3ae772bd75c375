"""Whether a mean over such paths is within a limit: what a promise needs beyond Student's t.

A metric that is never negative is judged on its logarithm, as `intervals.such_paths` has it.  A
share of time is nothing on many paths, where t would take no miss on n paths for none at all: it
is judged in two parts, (share of paths with any) × (share given any).  Where no path has any, only
the number of paths speaks (Clopper and Pearson), as another may miss all its time.
"""

from functools import cache
from math import ceil, log, log1p

import numpy as np
from scipy.special import betaincinv, stdtr

from ...base.arrays import FloatArray
from .intervals import relative_spread, such_paths
from .metric_kinds import Kind
from .paired import FAIL_ALPHA, PASS_LEVEL, Evidence, by_t, needed_replicates

_QUANTILES = (np.arange(8192) + 0.5) / 8192  # of the share of paths, for p down to .0002


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
    if kind in ("signed", "capped") or (kind == "positive" and not len(some)) or limit < 0.0:
        return by_t(beyond, alpha, level)
    found = such_paths(values, kind, 2.0 * level - 1.0)
    assert found is not None, "an extreme has no mean"
    if len(some):
        p = _p(len(values), some, 1.0 if kind == "share" else np.inf, limit)
        needed = needed_replicates(beyond, 0.0, alpha, level)
    else:
        p = 1.0  # nothing was seen beyond
        needed = ceil(log(1.0 - level) / log1p(-limit)) if 0.0 < limit < 1.0 else None
    return Evidence(p, float(beyond.mean()), found.high - limit, needed)


def _p(n: int, some: FloatArray, most: float, limit: float) -> float:
    """Return the p that the mean is within the limit: its confidence of being there."""
    k = len(some)
    error = relative_spread(some)[1] if k > 1 else 1.0  # as in `such_paths`
    everywhere = k == n and most == np.inf
    share = np.ones(1) if everywhere else _shares(k, n)
    room = limit / share  # what the mean of the paths with any may be
    with np.errstate(divide="ignore"):  # no room at all: certainly beyond
        above = np.log(room / some.mean())
    t = above / error if error > 0.0 else np.where(above >= 0.0, np.inf, -np.inf)
    within = np.asarray(stdtr(max(k - 1, 1), t), dtype=np.float64)
    return float(np.where(room >= most, 1.0, within).mean())


@cache
def _shares(k: int, n: int) -> FloatArray:
    """Return quantiles of the share of such paths with any, of which k of n had (Jeffreys)."""
    found: FloatArray = betaincinv(k + 0.5, n - k + 0.5, _QUANTILES)
    found.flags.writeable = False
    return found
