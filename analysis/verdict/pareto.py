"""The Pareto front over stability, lag, flicker and quality, each by one representative metric."""

from collections.abc import Sequence

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..study.comparison import ParetoFront, PolicyResult
from .uncertainty import Pool

AXES = (
    "over_budget_fraction",  # stability: whether the budget is kept
    "lag_ms_mean",  # lag
    "toggles_per_frame",  # flicker
    "sse_px_p95",  # quality: benefit_ratio saturates near full detail, the error does not
)
"""All four are better when lower."""


def pareto_front(costs: FloatArray) -> BoolArray:
    """Return which rows no other row dominates, (..., P) from (..., P, D).

    A row dominates another if it is nowhere higher and somewhere lower.  Equal rows stand together.
    A row with NaN is on no front and dominates nobody.
    """
    mine, other = costs[..., :, np.newaxis, :], costs[..., np.newaxis, :, :]
    dominates = np.all(other <= mine, axis=-1) & np.any(other < mine, axis=-1)
    complete = ~np.any(np.isnan(costs), axis=-1)
    front: BoolArray = np.logical_and(complete, ~np.any(dominates, axis=-1))
    return front


def find_front(results: Sequence[PolicyResult], pools: dict[str, Pool]) -> ParetoFront:
    """Return the front of scored policies, and how often each is on it among the resamples."""
    labels = [result.label for result in results]
    if not labels:
        return ParetoFront(AXES, (), {})
    values = [[result.metrics[axis].value for axis in AXES] for result in results]
    front = pareto_front(np.array(values, dtype=np.float64))
    names = tuple(label for label, is_on in zip(labels, front, strict=True) if is_on)
    if not all(axis in pools[label] for axis in AXES for label in labels):
        return ParetoFront(AXES, names, {})
    resampled = np.array([[pools[label][axis] for axis in AXES] for label in labels])
    share = pareto_front(np.moveaxis(resampled, 2, 0)).mean(axis=0)
    chances = {label: float(p) for label, p in zip(labels, share, strict=True)}
    return ParetoFront(AXES, names, chances)
