"""Work: what a policy costs the CPU, and what it makes the machine hold and draw."""

import numpy as np

from .measured_frames import MeasuredFrames
from .metric import metric
from .statistic import Statistic, maximum, mean, quantile


@metric("work", "ms", "lower")
def select_ms_mean(run: MeasuredFrames) -> Statistic:
    """Mean CPU time of the policy's own work, from its counts and the hardware's CPU cost model.

    Source: lodbench; selection time, which Zach et al. (VRST 2002) and Peng et al. (2011) report.
    """
    return mean(run["select_ms"])


@metric("work", "ms", "lower")
def select_ms_p99(run: MeasuredFrames) -> Statistic:
    """99th percentile of the CPU time of the policy's own work.

    Source: as select_ms_mean.
    """
    return quantile(run["select_ms"], 0.99)


@metric("work", "levels", "lower")
def levels_extracted_per_frame(run: MeasuredFrames) -> Statistic | None:
    """Levels built because no node held them; none where nothing is extracted.

    Source: LODManager of Gumbau, Ripolles and Chover.
    """
    return mean(run["levels_extracted"]) if _extracts(run) else None


@metric("work", "levels", "higher")
def levels_borrowed_per_frame(run: MeasuredFrames) -> Statistic | None:
    """Levels drawn that another node had extracted; none where nothing is extracted.

    Source: LODManager of Gumbau, Ripolles and Chover.
    """
    return mean(run["levels_borrowed"]) if _extracts(run) else None


@metric("work", "triangles", "lower")
def triangles_mean(run: MeasuredFrames) -> Statistic:
    """Mean triangles drawn in a frame, cross-fades included.

    Source: every engine's counter, such as Unreal's RHI/PrimitivesDrawn.
    """
    return mean(run["triangles"])


@metric("work", "fraction", "lower")
def memory_peak_fraction(run: MeasuredFrames) -> Statistic | None:
    """Largest memory held by levels over the hardware's bound.

    Source: lodbench; the bound is the profile's.
    """
    bound = run.header.memory_bound_bytes
    return maximum(run["memory_bytes"] / bound) if bound > 0.0 else None


def _extracts(run: MeasuredFrames) -> bool:
    return bool(np.any(run["levels_extracted"]) or np.any(run["levels_borrowed"]))
