"""Whether simulation and recordings order policies alike, where recordings can tell them apart."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ..validation_result import Rank

_SURE = 0.975
"""One-sided: two equal policies are told apart in one metric in one of twenty validations."""


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs of policies in one metric.

    Attributes
    ----------
    apart : (p,) bool
        Whether the recordings tell a pair apart.
    measured : (p,) float64
        Sign of its difference in them.
    simulated : (p,) float64
        Sign of its difference in the mean over the replicates.
    replicates : (p, R) float64
        Sign of its difference in each.
    again : float or None
        Kendall's τ of the two recordings.
    """

    apart: BoolArray
    measured: FloatArray
    simulated: FloatArray
    replicates: FloatArray
    again: float | None


def compare_pairs(measured: FloatArray, replicates: FloatArray) -> Pairs | None:
    """Return the pairs of the policies that have a metric, None where no two have.

    Two recordings a policy are needed to tell any apart: the differences of both, over P policies,
    say what one recording is off by, and two are apart whose means differ by more than Student's t
    at P degrees of freedom has it.

    Parameters
    ----------
    measured : (P, 1 or 2) float64
        NaN where a recording has no value.
    replicates : (P, R) float64
    """
    from scipy.stats import t

    student: Any = t
    known = ~(np.isnan(measured).any(axis=1) | np.isnan(replicates).any(axis=1))
    measured, replicates = measured[known], replicates[known]
    count, passes = measured.shape
    if count < 2:
        return None
    first, second = np.array(list(combinations(range(count), 2))).T
    means = measured.mean(axis=1)
    difference = means[first] - means[second]
    apart: BoolArray = np.zeros(len(first), dtype=np.bool_)
    again = None
    if passes > 1:
        variance = float((np.diff(measured[:, :2], axis=1) ** 2).mean()) / 2.0  # of one recording
        # The difference of two means of two recordings has this variance too.
        least = float(student.ppf(_SURE, count)) * variance**0.5
        apart = np.abs(difference) > least
        again = kendall_tau(measured[:, 0].tolist(), measured[:, 1].tolist())
    simulated = replicates.mean(axis=1)
    return Pairs(
        apart,
        np.sign(difference),
        np.sign(simulated[first] - simulated[second]),
        np.sign(replicates[first] - replicates[second]),
        again,
    )


def rank(parts: Iterable[Pairs], level: float) -> Rank:
    """Return τ over the pairs of all parts that the recordings tell apart.

    Its interval is that over the replicates: each has one draw of the machine and one seed, which
    all policies share.
    """
    parts = list(parts)
    pairs = sum(len(part.apart) for part in parts)
    again = [part.again for part in parts if part.again is not None]
    both = float(np.mean(again)) if again else None
    apart = sum(int(part.apart.sum()) for part in parts)
    if not apart:
        return Rank(None, None, None, 0, pairs, both)
    signs = np.concatenate([part.measured[part.apart] for part in parts])
    mean = np.concatenate([part.simulated[part.apart] for part in parts])
    each = np.concatenate([part.replicates[part.apart] for part in parts])
    taus = (signs[:, None] * each).mean(axis=0)
    low, high = np.quantile(taus, ((1.0 - level) / 2.0, (1.0 + level) / 2.0)).tolist()
    return Rank(float((signs * mean).mean()), low, high, apart, pairs, both)


def kendall_tau(first: Sequence[float | None], second: Sequence[float | None]) -> float | None:
    """Return Kendall's τ-b of paired values: 1 for the same order, −1 for the reverse.

    None where fewer than two pairs are complete, or one side does not tell any two apart.
    """
    from scipy.stats import kendalltau

    pairs = [(a, b) for a, b in zip(first, second, strict=True) if a is not None and b is not None]
    if len({a for a, _ in pairs}) < 2 or len({b for _, b in pairs}) < 2:
        return None
    found: Any = kendalltau(*np.array(pairs).T)
    return float(found.statistic)
