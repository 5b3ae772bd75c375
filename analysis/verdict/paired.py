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
from .intervals import welch_degrees

Verdict = Literal["pass", "fail", "undecided"]

FAIL_ALPHA = 0.01
"""Chance that any of all limits together fails although each is kept."""

PASS_LEVEL = 0.95
"""Confidence of the one-sided interval that must lie within the limit to pass."""

_POWER = 0.8  # chance with which the replicates asked for would decide, were the means as seen
_MOST = 10_000  # replicates that nobody makes


@dataclass(frozen=True, slots=True)
class Evidence:
    """What the replicates of one limit say, before all limits are judged together.

    Attributes
    ----------
    p : float
        Of an excess as large as seen, were the limit kept; nan where nothing tells.
    excess, high : float
        Mean of the excess over the limit, and the upper end of its one-sided interval.
    needed : int or None
        Replicates that would decide; None if no sensible number would.
    """

    p: float
    excess: float
    high: float
    needed: int | None = None


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
    return by_t(excess(now, then, limit, relative=relative)).p


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


def decide(evidence: Sequence[Evidence], alpha: float = FAIL_ALPHA) -> tuple[Judgement, ...]:
    """Return the judgement of each of m limits, from what is known of it.

    A limit fails if that is shown by Holm's procedure over all m; it passes if the one-sided
    interval of its excess ends within it; else it is undecided.
    """
    judgements: list[Judgement] = []
    for of, fails in zip(evidence, holm([of.p for of in evidence], alpha), strict=True):
        verdict: Verdict = "fail" if fails else "pass" if of.high <= 0 else "undecided"
        needed = of.needed if verdict == "undecided" else None
        judgements.append(Judgement(verdict, of.p, of.excess, of.high, needed))
    return tuple(judgements)


def by_t(beyond: FloatArray, alpha: float = FAIL_ALPHA, level: float = PASS_LEVEL) -> Evidence:
    """Return what replicates say of the mean excess, by Student's t on one side.

    Replicates on several fixed paths are compared with those of their own path alone, as how paths
    differ is no doubt about these very paths; noise may differ from path to path (Welch).
    Replicates that are all alike show the excess without doubt; a single one shows nothing.

    Parameters
    ----------
    beyond : (R,) float64, or (n, S) float64
        Excess of R replicates, or of S replicates on each of n paths.
    alpha : float
        Chance of failing wrongly that is left for this limit.
    """
    rows = np.atleast_2d(beyond)
    n, each = rows.shape
    mean = float(rows.mean())
    if each < 2:
        return Evidence(float("nan"), mean, float("inf"))
    if not _spread(rows):
        return Evidence(0.0 if mean > 0 else 1.0, mean, mean)
    errors: FloatArray = rows.var(axis=1, ddof=1) / each
    error = sqrt(float(errors.sum())) / n
    degrees = welch_degrees(errors, each - 1.0)
    return Evidence(
        p=_tail(degrees, mean / error),
        excess=mean,
        high=mean + float(stdtrit(degrees, level)) * error,
        needed=needed_replicates(rows, 0.0, alpha, level),
    )


def as_observed(beyond: float) -> Evidence:
    """Return what an extreme says, which is judged as it was seen and not as a mean."""
    return Evidence(0.0 if beyond > 0 else 1.0, beyond, beyond)


def needed_replicates(
    diff: FloatArray, limit: float, alpha: float = FAIL_ALPHA, level: float = PASS_LEVEL
) -> int | None:
    """Return how many replicates would decide with chance .8, were mean and spread as seen.

    None if one replicate shows no spread, if the mean lies on the limit, or if it takes more than
    10,000.

    Parameters
    ----------
    diff : (R,) or (n, S) float64
        Of the replicates at hand; of n paths, what is needed on each.
    alpha, level : float
        Chance of failing wrongly, and confidence of passing.
    """
    rows = np.atleast_2d(diff)
    n, each = rows.shape
    distance = abs(float(rows.mean()) - limit)
    if each < 2 or distance == 0:
        return None
    error = alpha if rows.mean() > limit else 1 - level
    spread = sqrt(float(rows.var(axis=1, ddof=1).sum())) / n

    def decides(count: int) -> bool:
        degrees = float(n * (count - 1))
        wanted = float(np.float64(stdtrit(degrees, 1 - error) + stdtrit(degrees, _POWER)))
        return distance >= wanted * spread / sqrt(count)

    counts = range(2, _MOST + 1)
    found = bisect_left(counts, True, key=decides)  # more replicates never decide less
    return counts[found] if found < len(counts) else None


def _tail(degrees: float, t: float) -> float:
    """Return the chance of at least t."""
    return float(np.float64(stdtr(degrees, -t)))


def _spread(rows: NDArray[np.float64]) -> bool:
    """Return whether the values of any row differ by more than rounding."""
    return bool((np.ptp(rows, axis=1) > 1e-12 * np.abs(rows).max()).any())
