"""The gate's statistics: is a limit shown to be broken, shown to be kept, or neither.

Replicates of both sides share path, seed and machine draw, so that what is judged is their paired
difference.  Values are turned so that more is worse; of a metric in which more is better, callers
hand the negatives.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr, stdtrit

from ...base.arrays import BoolArray, FloatArray

Verdict = Literal["pass", "fail", "undecided"]

FAIL_ALPHA = 0.01
"""Chance that any of all limits together fails although each is kept."""

PASS_LEVEL = 0.95
"""Confidence of the one-sided interval that must lie within the limit to pass."""

_POWER = 0.8  # chance with which the replicates asked for would decide, were the means as seen
_MOST = 10_000  # replicates that nobody makes


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the replicates say of one limit.

    Attributes
    ----------
    verdict : "pass", "fail" or "undecided"
    p : float
        Of an excess as large as seen, were the limit kept; nan from one replicate.
    excess, high : float
        Mean of the excess over the limit, and the upper end of its one-sided interval.
    needed : int or None
        Replicates that would decide; None if decided, or if no sensible number would.
    """

    verdict: Verdict
    p: float
    excess: float
    high: float
    needed: int | None


def excess(now: FloatArray, then: FloatArray, limit: float, *, relative: bool) -> FloatArray:
    """Return by how much each replicate is beyond the limit, (R,): positive where it is broken.

    A relative limit is a share of `then`; an absolute one is in the metric's unit.  To limit `now`
    alone, `then` is zeros.
    """
    return now - then - limit * (np.abs(then) if relative else 1.0)


def one_sided_p(now: FloatArray, then: FloatArray, limit: float, *, relative: bool) -> float:
    """Return the p that the limit is kept and the excess of R replicates is chance (Student's t).

    Replicates that are all alike show it without doubt: 0 beyond the limit, 1 within.  From one
    replicate the answer is nan.
    """
    return _p(excess(now, then, limit, relative=relative))


def holm(p: Sequence[float] | FloatArray, alpha: float = FAIL_ALPHA) -> BoolArray:
    """Return which of m hypotheses are rejected, (m,), erring in any with chance `alpha` at most.

    A nan is never rejected, and counts among the m.

    Source: Holm, Scandinavian Journal of Statistics 6 (1979).
    """
    values = np.asarray(p, dtype=np.float64)
    order = np.argsort(values, kind="stable")  # nan last
    m = len(values)
    # The first that stands lets all behind it stand.
    passed = np.logical_and.accumulate(values[order] <= alpha / np.arange(m, 0, -1))
    rejected = np.zeros(m, dtype=np.bool_)
    rejected[order] = passed
    return rejected


def judge(
    excesses: Sequence[FloatArray], alpha: float = FAIL_ALPHA, level: float = PASS_LEVEL
) -> tuple[Judgement, ...]:
    """Return the judgement of each of m limits, from what its replicates exceed it by.

    A limit fails if that is shown by Holm's procedure over all m; it passes if the one-sided
    interval of its excess ends within it; else it is undecided.

    Parameters
    ----------
    excesses : m arrays (R,) float64
        As `excess` gives them; limits may have replicates of their own number.
    """
    p = [_p(of) for of in excesses]
    failed = holm(p, alpha)
    judgements: list[Judgement] = []
    for of, p_of, fails in zip(excesses, p, failed, strict=True):
        high = _upper(of, level)
        verdict: Verdict = "fail" if fails else "pass" if high <= 0 else "undecided"
        needed = None
        if verdict == "undecided":
            needed = needed_replicates(of, 0.0, alpha / len(excesses), level)
        judgements.append(Judgement(verdict, p_of, float(of.mean()), high, needed))
    return tuple(judgements)


def needed_replicates(
    diff: FloatArray, limit: float, alpha: float = FAIL_ALPHA, level: float = PASS_LEVEL
) -> int | None:
    """Return how many replicates would decide with chance .8, were mean and spread as seen.

    None if one replicate shows no spread, if the mean lies on the limit, or if it takes more than
    10,000.

    Parameters
    ----------
    diff : (R,) float64
        Of the replicates at hand.
    alpha, level : float
        Chance of failing wrongly, and confidence of passing.
    """
    distance = abs(float(diff.mean()) - limit)
    if len(diff) < 2 or distance == 0:
        return None
    error = alpha if diff.mean() > limit else 1 - level
    sd = float(diff.std(ddof=1))

    def decide(n: int) -> bool:
        wanted = float(stdtrit(n - 1, 1 - error) + stdtrit(n - 1, _POWER))
        return distance >= wanted * sd / sqrt(n)

    counts = range(2, _MOST + 1)
    found = bisect_left(counts, True, key=decide)  # more replicates never decide less
    return counts[found] if found < len(counts) else None


def _p(beyond: FloatArray) -> float:
    """Return the p of a mean excess of 0 or less."""
    if len(beyond) < 2:
        return float("nan")
    if not _spread(beyond):
        return 0.0 if beyond[0] > 0 else 1.0
    error = float(beyond.std(ddof=1)) / sqrt(len(beyond))
    t = float(beyond.mean()) / error
    return float(stdtr(len(beyond) - 1, -t))


def _upper(beyond: FloatArray, level: float) -> float:
    """Return the upper end of the one-sided interval of the mean excess; inf from one replicate."""
    if len(beyond) < 2:
        return float("inf")
    if not _spread(beyond):
        return float(beyond[0])
    half = stdtrit(len(beyond) - 1, level) * beyond.std(ddof=1) / np.sqrt(len(beyond))
    return float(beyond.mean() + half)


def _spread(values: NDArray[np.float64]) -> bool:
    """Return whether the values differ by more than rounding."""
    return bool(np.ptp(values) > 1e-12 * np.abs(values).max())
