"""Policies in order, as far as their difference is shown.

Everybody starts in one group.  The best mean of the first metric leads; who is not shown to be
worse than that by more than the margin stays with it, the rest are split in the same way.  Each
group of equals is then split by the next metric, and so on: a group that is left shares a rank.
Equality is with who leads: two members of a group may differ from each other.

Not shown to be worse is not shown to be equal.  A later metric puts nobody behind a leader whose
mean in an earlier one is more than twice theirs: few pops do not decide against a picture of 4 px
for one of 29 because four paths are too few to show that 4 is less.  They share the rank.  Less
than that is what noise makes of equals, whom a later metric may well tell apart.

Policies that no metric tells apart go together, wherever one of them goes.  Otherwise two that
decide alike would come to stand on either side of a border by chance: a quarter of the time, where
it runs close by them.

Not shown to be worse is little praise from few paths.  So a group is named after the one that is
first by the means as they are, the margin applied, and not after who has the least of the last
metric: that one may be far off in the first, and noisy.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.special import stdtr

from ...base.arrays import BoolArray, FloatArray, IntArray
from .criterion import Criterion, beyond_margin

ALPHA = 0.05
"""Chance that a policy just within the margin is shown to be beyond it, in one metric; and that
two equal policies on ten paths are told apart, in all metrics together."""

_APART = 3.0
"""Standard errors by which two that are told apart differ: of ten paths what Student's t asks at
`ALPHA` over three metrics.  Of four it would ask five, and chain together all that is noisy."""

_FAR = 2.0
"""Times the mean of another from which on a later metric decides nothing: of equals whose paths
differ by half on a logarithm, one in forty pairs on four paths, and one in a thousand on ten."""


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
        Labels in the order of their means: first who is within the margin of the best in each
        metric and has the least of the last; then who would be, were those before not there.
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
    groups = _split(list(range(len(order))), turned, (), _kin(turned), alpha)
    found: list[RankGroup] = []
    for rank, (members, by) in enumerate(groups, start=1):
        names = tuple(sorted_labels[i] for i in _by_means(members, turned))
        found.append(RankGroup(rank, names[0], names, by))
    return tuple(found)


def _split(
    policies: list[int],
    criteria: Sequence[Criterion],
    before: tuple[Criterion, ...],
    kin: IntArray,
    alpha: float,
) -> list[tuple[list[int], str | None]]:
    """Return groups of policies, with the metric that put each behind the last.

    `before` are the metrics by which these policies were not told apart.
    """
    if not criteria or len(policies) == 1:
        return [(policies, None)]
    criterion, *others = criteria
    mean = criterion.values.mean(axis=1)
    rest = sorted(policies, key=lambda i: (mean[i], i))
    groups: list[tuple[list[int], str | None]] = []
    while rest:
        worse = _shown_worse(criterion.values[rest], criterion, alpha) & ~_ahead(rest, before)
        with_leader = np.isin(kin[rest], kin[rest][~worse])
        inner = _split(_where(rest, with_leader), others, (*before, criterion), kin, alpha)
        if groups:
            inner[0] = (inner[0][0], criterion.name)
        groups += inner
        rest = _where(rest, ~with_leader)
    return groups


def _ahead(policies: list[int], criteria: Sequence[Criterion]) -> BoolArray:
    """Return whose mean is better than the first's in a metric, `_FAR` times and more, (m,)."""
    ahead = np.zeros(len(policies), dtype=np.bool_)
    for criterion in criteria:
        mean = criterion.values[policies].mean(axis=1)
        far = beyond_margin(np.full_like(mean, mean[0]), mean, criterion) > 0.0
        ahead |= far & (mean[0] - mean > (_FAR - 1.0) * np.abs(mean))
    return ahead


def _where(policies: list[int], chosen: BoolArray) -> list[int]:
    """Return the policies that are chosen, in their order."""
    return [i for i, is_chosen in zip(policies, chosen, strict=True) if is_chosen]


def _by_means(left: list[int], criteria: Sequence[Criterion]) -> list[int]:
    """Return policies in the order of their means, where a margin of the best decides nothing."""
    ordered: list[int] = []
    while left:
        near = left
        for criterion in criteria:
            mean = criterion.values[near].mean(axis=1)
            near = _where(near, beyond_margin(mean, mean.min(), criterion) <= 0)
        last = criteria[-1].values
        ordered.append(min(near, key=lambda i: (float(last[i].mean()), i)))
        left = [i for i in left if i != ordered[-1]]
    return ordered


def _kin(criteria: Sequence[Criterion]) -> IntArray:
    """Return a number for each policy, (P,), that is equal for those that go together.

    Two are told apart by their paired difference in any metric, without margin.
    """
    policies = len(criteria[0].values)
    apart = np.zeros((policies, policies), dtype=np.bool_)
    for criterion in criteria:
        for i, values in enumerate(criterion.values):
            far = _is_far(criterion.values - values)
            apart[:, i] |= far
            apart[i] |= far
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


def _is_far(difference: FloatArray) -> BoolArray:
    """Return of which differences, (m, n), the mean is `_APART` standard errors off 0, (m,)."""
    n = difference.shape[1]
    if n < 2:
        return np.zeros(len(difference), dtype=np.bool_)
    error = difference.std(axis=1, ddof=1) / np.sqrt(n)
    return np.abs(difference.mean(axis=1)) > _APART * error


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
