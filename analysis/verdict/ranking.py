"""Policies in order, as far as their difference is shown.

Everybody starts in one group.  Its leader has the best mean of the first metric; who is not shown
to be worse than the leader by more than the margin stays with it, the rest are split in the same
way.  Each group of equals is then split by the next metric, and so on: a group that is left shares
a rank.  Equality is with the leader alone: two members of a group may differ from each other.

Policies that no metric tells apart go together, wherever one of them goes.  Otherwise two that
decide alike would come to stand on either side of a border by chance: a quarter of the time, where
it runs close by them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.special import stdtr

from ...base.arrays import BoolArray, FloatArray, IntArray
from .criterion import Criterion

ALPHA = 0.05
"""Chance that a policy just within the margin is shown to be beyond it, in one metric; and that
two equal policies are told apart, in all metrics together."""


@dataclass(frozen=True, slots=True)
class RankGroup:
    """Policies that share a rank.

    Attributes
    ----------
    rank : int
        From 1; the next group has the next number.
    leader : str
        The policy with which all members are equal.
    members : tuple of str
        Labels, the leader first, then by the mean of the metric that was judged last.
    behind_by : str or None
        The metric that put the group behind the one before; None for the first.
    """

    rank: int
    leader: str
    members: tuple[str, ...]
    behind_by: str | None


def ranking(
    labels: Sequence[str], criteria: Sequence[Criterion], alpha: float = ALPHA
) -> tuple[RankGroup, ...]:
    """Return the groups of P policies, best first.

    Policies are compared path by path, by Student's t; from one path nothing is shown, and all are
    equal.  Ties of means go by label, never by the order of the input.

    Parameters
    ----------
    labels : P strings, all different
    criteria : sequence of Criterion
        In the order in which they judge, each of the P policies on the same n paths.
    """
    if not labels:
        return ()
    order = sorted(range(len(labels)), key=lambda i: labels[i])
    sorted_labels = [labels[i] for i in order]
    turned = [replace(of, values=of.turned()[order], better="lower") for of in criteria]
    groups = _split(list(range(len(order))), turned, _kin(turned, alpha), alpha)
    return tuple(
        RankGroup(rank, sorted_labels[members[0]], tuple(sorted_labels[i] for i in members), by)
        for rank, (members, by) in enumerate(groups, start=1)
    )


def _split(
    policies: list[int], criteria: Sequence[Criterion], kin: IntArray, alpha: float
) -> list[tuple[list[int], str | None]]:
    """Return groups of policies, leader first, with the metric that put each behind the last."""
    if not criteria or len(policies) == 1:
        return [(policies, None)]
    criterion, *others = criteria
    mean = criterion.values.mean(axis=1)
    rest = sorted(policies, key=lambda i: (mean[i], i))
    groups: list[tuple[list[int], str | None]] = []
    while rest:
        worse = _shown_worse(criterion.values[rest], criterion, alpha)
        with_leader = np.isin(kin[rest], kin[rest][~worse])
        inner = _split(_where(rest, with_leader), others, kin, alpha)
        if groups:
            inner[0] = (inner[0][0], criterion.name)
        groups += inner
        rest = _where(rest, ~with_leader)
    return groups


def _where(policies: list[int], chosen: BoolArray) -> list[int]:
    """Return the policies that are chosen, in their order."""
    return [i for i, is_chosen in zip(policies, chosen, strict=True) if is_chosen]


def _kin(criteria: Sequence[Criterion], alpha: float) -> IntArray:
    """Return a number for each policy, (P,), that is equal for those that go together.

    Two are told apart by a two-sided paired t in any metric, without margin, at `alpha` over all
    metrics (Bonferroni).
    """
    policies = len(criteria[0].values)
    apart = np.zeros((policies, policies), dtype=np.bool_)
    for criterion in criteria:
        for i, values in enumerate(criterion.values):
            worse = _p_not_positive(criterion.values - values) < alpha / len(criteria) / 2
            apart[:, i] |= worse
            apart[i] |= worse
    return connected_components(~apart, directed=False)[1]


def _shown_worse(values: FloatArray, criterion: Criterion, alpha: float) -> BoolArray:
    """Return who is shown to be worse than the first by more than the margin, (m,), of (m, n).

    The larger margin counts, so both must be exceeded; each is tested with the leader's own
    uncertainty in it (an intersection-union test, which keeps its level).
    """
    leader = values[0]
    shown = np.ones(len(values), dtype=np.bool_)
    for margin in (criterion.relative * np.abs(leader), np.full_like(leader, criterion.absolute)):
        shown &= _p_not_positive(values - leader - margin) < alpha
    shown[0] = False
    return shown


def _p_not_positive(beyond: FloatArray) -> FloatArray:
    """Return the one-sided p, (m,), of means as large as seen although they are 0 or less."""
    n = beyond.shape[1]
    mean = beyond.mean(axis=1)
    if n < 2:
        return np.ones_like(mean)
    error = beyond.std(axis=1, ddof=1) / np.sqrt(n)
    # Spread within rounding of the values is none: such differences are plain.
    plain = error <= 1e-12 * np.abs(beyond).max(axis=1)
    t: FloatArray = mean / np.where(plain, 1.0, error)
    return np.where(plain, np.where(beyond[:, 0] > 0, 0.0, 1.0), stdtr(n - 1, -t))
