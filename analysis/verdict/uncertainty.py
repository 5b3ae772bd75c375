"""Intervals and probabilities from resamples of every policy, pooled over posterior draws.

Resample r of one policy and resample r of another are of the same draw and the same blocks of time,
so that what they share does not blur their difference.
"""

from typing import TypeAlias

import numpy as np

from ...base.arrays import FloatArray
from ..metrics.metric_registry import METRICS
from ..study.score import Scored

LEVEL = 0.9
"""Share of resamples between the low and high end of an interval."""

Pool: TypeAlias = dict[str, FloatArray]
"""Resampled values by metric, (R,) each; no entry where the run says nothing of their spread."""


def pool_of(mean: Scored, drawn: list[Scored]) -> Pool:
    """Return the resamples of all draws; of the mean where the profile has no draws."""
    runs = drawn or [mean]
    ids = [metric.id for metric in METRICS if all(metric.id in run.resampled for run in runs)]
    return {name: np.concatenate([run.resampled[name] for run in runs]) for name in ids}


def interval(resampled: FloatArray | None) -> tuple[float | None, float | None]:
    """Return the ends that hold `LEVEL` of the resamples between them, or None and None."""
    if resampled is None or np.isnan(resampled).all():
        return None, None
    low, high = np.nanquantile(resampled, ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0))
    return float(low), float(high)


def beats(pools: dict[str, Pool]) -> dict[str, dict[str, tuple[float | None, ...]]]:
    """Return by metric and label the probability of being better than each policy in turn."""
    tables: dict[str, dict[str, tuple[float | None, ...]]] = {}
    for metric in METRICS:
        sign = 1.0 if metric.better == "lower" else -1.0
        table = {
            label: tuple(
                None if mine is other else _better(sign, mine.get(metric.id), other.get(metric.id))
                for other in pools.values()
            )
            for label, mine in pools.items()
        }
        if any(p is not None for row in table.values() for p in row):
            tables[metric.id] = table
    return tables


def _better(sign: float, mine: FloatArray | None, other: FloatArray | None) -> float | None:
    """Return the share of paired resamples in which `mine` is better; a tie counts half."""
    if mine is None or other is None:
        return None
    difference = sign * (mine - other)
    difference = difference[~np.isnan(difference)]
    if not len(difference):
        return None
    return float((difference < 0.0).mean() + 0.5 * (difference == 0.0).mean())
