"""Work: what a policy costs the CPU, and what it makes the machine hold and draw."""

import numpy as np

from .measured_frames import MeasuredFrames
from .metric import metric
from .over_frames import most
from .over_time import time_mean, time_quantile


@metric("work", "ms", "lower")
def select_ms_mean(run: MeasuredFrames) -> float | None:
    """Mean over time of the CPU time of a policy's own work, from its counts and the cost model.

    Source: lodbench; selection time, which Zach et al. (VRST 2002) and Peng et al. (2011) report.
    """
    return time_mean(run["select_ms"], run.cost_weight_ms)


@metric("work", "ms", "lower")
def select_ms_p99(run: MeasuredFrames) -> float | None:
    """99th percentile over time of the CPU time of the policy's own work.

    Source: as select_ms_mean.
    """
    return time_quantile(run["select_ms"], run.cost_weight_ms, 0.99)


@metric("work", "1/s", "lower")
def levels_changed_per_s(run: MeasuredFrames) -> float | None:
    """Levels built in a second because no node held them; none where nothing is extracted.

    Source: LODManager of Gumbau, Ripolles and Chover.
    """
    return _levels_per_s(run, "levels_extracted")


@metric("work", "1/s", "higher")
def levels_borrowed_per_s(run: MeasuredFrames) -> float | None:
    """Levels drawn in a second that another node had extracted; none where nothing is extracted.

    Source: LODManager of Gumbau, Ripolles and Chover.
    """
    return _levels_per_s(run, "levels_borrowed")


@metric("work", "triangles", "lower")
def triangles_mean(run: MeasuredFrames) -> float | None:
    """Mean over time of the triangles drawn in a frame, cross-fades included.

    Source: every engine's counter, such as Unreal's RHI/PrimitivesDrawn.
    """
    return time_mean(run["triangles"], run.cost_weight_ms)


@metric("work", "fraction", "lower")
def memory_peak_fraction(run: MeasuredFrames) -> float | None:
    """Largest memory held by levels over the hardware's bound, as observed.

    Source: lodbench; the bound is the profile's.
    """
    bound = run.header.memory_bound_bytes
    return most(run["memory_bytes"] / bound) if bound > 0.0 else None


def _levels_per_s(run: MeasuredFrames, column: str) -> float | None:
    if not (np.any(run["levels_extracted"]) or np.any(run["levels_borrowed"])):
        return None
    return float(run[column].sum()) / run.window_s
