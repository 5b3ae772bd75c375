"""The verdict, simulated and measured: who keeps the budget, and who is first.

The order is the verdict's own, on one path: of those that keep the budget, who is within the margin
of the best in one metric is judged by the next, and the least work leads.  Where nobody keeps it,
who misses it by least leads.
"""

from collections.abc import Iterable

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ...verdict.criterion import RELATIVE_MARGIN, Criterion, beyond_margin
from ...verdict.verdict import LEAST
from ..validation_result import Decided, Decision

SURE = 0.9
"""Share of the replicates that decides."""

FAR = 0.25
"""Part of the budget: a policy further off it has to be decided."""


def decide(yes: BoolArray, measured: BoolArray) -> Decision:
    """Return how a question is decided by R replicates, (R,), and by the recordings, (1 or 2,)."""
    probability = float(yes.mean())
    count = len(yes)
    most, least = round(SURE * count, 9), round((1.0 - SURE) * count, 9)
    decided = "yes" if yes.sum() >= most else "no" if yes.sum() <= least else "undecided"
    found = bool(measured[0]) if (measured == measured[0]).all() else None
    open_ = decided == "undecided" or found is None
    return Decision(probability, decided, found, None if open_ else (decided == "yes") == found)


def leaders(keeps: BoolArray, judged_ms: FloatArray, values: dict[str, FloatArray]) -> FloatArray:
    """Return the share of the first place of each policy in each of n runs, (P, n): all or equal.

    Who is equal to the best in all metrics within their margins is first too, by 1; others have 0.

    Parameters
    ----------
    keeps : (P, n) bool
        Who keeps the budget.
    judged_ms : (P, n) float64
        Work time by which the budget is judged.
    values : dict of str to (P, n) float64
        By the metrics of `LEAST`, in the order in which they judge.
    """
    nobody = ~keeps.any(axis=0)
    nearest = judged_ms <= (1.0 + RELATIVE_MARGIN) * judged_ms.min(axis=0)
    left: BoolArray = np.where(nobody, nearest, keeps)
    for name, table in values.items():
        criterion = Criterion(name, table, absolute=LEAST[name])
        known = np.where(np.isnan(table), np.inf, table)
        least = np.where(left, known, np.inf).min(axis=0)
        least = np.where(np.isfinite(least), least, 0.0)  # nobody has it: all are equal
        within = beyond_margin(np.where(np.isnan(table), least, table), least, criterion) <= 0
        left = left & (within | nobody)
    return left.astype(np.float64)


def first_of(left: FloatArray, judged_ms: FloatArray) -> list[int]:
    """Return who leads in each run: of those in the first place, the one with the least work."""
    return np.where(left > 0.0, judged_ms, np.inf).argmin(axis=0).tolist()


def count_decided(decisions: Iterable[tuple[Decision, float]], far: float = FAR) -> Decided:
    """Return how many decisions agree.

    Parameters
    ----------
    decisions
        Each with how far its recordings are off the limit, as a share of it; those that recordings
        leave open do not count.
    """
    asked = undecided = right = far_off = 0
    for decision, off in decisions:
        if decision.measured is None:
            continue
        asked += 1
        if decision.as_measured is None:
            undecided += 1
            far_off += off > far
        else:
            right += decision.as_measured
    return Decided(asked, undecided, right, far_off)
