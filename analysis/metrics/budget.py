"""Budget: how much of the time a policy's work keeps within the budget, and how far it leaves it.

``work_ms`` is the larger of CPU and GPU time, which no refresh quantises.  A frame counts for as
long as the screen waited for it, so that a slow one carries its own time.
"""

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .measured_frames import MeasuredFrames
from .metric import metric
from .over_frames import most
from .over_time import time_mean, time_quantile


@metric("budget", "fraction", "lower")
def over_budget_time_fraction(run: MeasuredFrames) -> float | None:
    """Share of time in frames whose work_ms exceeds the budget.

    Source: deadline miss ratio of soft real-time systems, over time in place of jobs.
    """
    return time_mean(_over(run).astype(np.float64), run.cost_weight_ms)


@metric("budget", "ms", "lower")
def work_ms_mean(run: MeasuredFrames) -> float | None:
    """Mean over time of the larger of CPU and GPU time.

    Source: lodbench; the time that no refresh quantises.
    """
    return time_mean(run.work_ms, run.cost_weight_ms)


@metric("budget", "ms", "lower")
def work_ms_p50(run: MeasuredFrames) -> float | None:
    """Median over time of the larger of CPU and GPU time.

    Source: as work_ms_mean; the least value that holds half of the time.
    """
    return time_quantile(run.work_ms, run.cost_weight_ms, 0.50)


@metric("budget", "ms", "lower")
def work_ms_p95(run: MeasuredFrames) -> float | None:
    """95th percentile over time of the larger of CPU and GPU time.

    Source: as work_ms_p50.
    """
    return time_quantile(run.work_ms, run.cost_weight_ms, 0.95)


@metric("budget", "ms", "lower")
def work_ms_p99(run: MeasuredFrames) -> float | None:
    """99th percentile over time of the larger of CPU and GPU time.

    Source: as work_ms_p50.
    """
    return time_quantile(run.work_ms, run.cost_weight_ms, 0.99)


@metric("budget", "ms", "lower")
def work_ms_max(run: MeasuredFrames) -> float | None:
    """Largest CPU or GPU time of a frame, as observed.

    Source: standard.
    """
    return most(run.work_ms)


@metric("budget", "ratio", "lower")
def over_budget_max_ratio(run: MeasuredFrames) -> float | None:
    """Largest work_ms over the budget, as observed; at most 1 if the budget always held.

    Source: worst case of the deadline miss ratio.
    """
    return most(run.work_ms / run.header.budget_ms)


@metric("budget", "ms", "lower")
def longest_over_budget_ms(run: MeasuredFrames) -> float | None:
    """Longest time of successive frames whose work_ms exceeds the budget, as observed.

    Source: lodbench; a run of misses is seen where a single one is not.
    """
    return longest_stretch_ms(_over(run), run.cost_weight_ms)


@metric("budget", "ratio", "lower")
def utilisation(run: MeasuredFrames) -> float | None:
    """Mean over time of work_ms over the budget; what is unused shows in benefit_ratio.

    Source: utilisation of queueing theory.
    """
    return time_mean(run.work_ms / run.header.budget_ms, run.cost_weight_ms)


def longest_stretch_ms(flags: BoolArray, weight_ms: FloatArray) -> float:
    """Return the most time that successive frames with a flag set take together; 0 without one."""
    before = np.concatenate(((0.0,), np.cumsum(weight_ms)))
    edges = np.diff(flags.astype(np.int8), prepend=0, append=0)
    times_ms = before[edges == -1] - before[edges == 1]
    return float(times_ms.max(initial=0.0))


def _over(run: MeasuredFrames) -> BoolArray:
    return run.work_ms > run.header.budget_ms
