"""Quality: how much of full detail is shown."""

import numpy as np

from .measured_frames import MeasuredFrames
from .metric import metric
from .statistic import Statistic, mean, ratio


@metric("quality", "px", "lower")
def sse_px_p95(run: MeasuredFrames) -> Statistic:
    """Mean over frames of the 95th percentile, over nodes drawn, of projected geometric error.

    Source: screen-space error of CesiumJS, error · height / (distance · 2 tan(fovy / 2)).
    """
    return mean(np.where(run["drawn"] > 0.0, run["sse_px_p95"], np.nan))


@metric("quality", "ratio", "higher")
def benefit_ratio(run: MeasuredFrames) -> Statistic:
    """Benefit of what was drawn over the benefit of full detail, sum over sum.

    Source: Benefit of Funkhouser and Séquin, SIGGRAPH 1993.
    """
    return ratio(run["benefit"], run["full_benefit"])


@metric("quality", "ratio", "lower")
def degradation_mean(run: MeasuredFrames) -> Statistic:
    """Degradation of what was drawn over that of full detail, sum over sum; 1 at full detail.

    Source: Degradation of Gobbetti and Bouvier, Time-critical multiresolution rendering of large
    complex models.
    """
    return ratio(run["degradation"], run["full_degradation"])


@metric("quality", "nodes", "lower")
def missing_objects_per_frame(run: MeasuredFrames) -> Statistic:
    """Candidates in the frustum of which nothing was drawn.

    Source: lodbench; holes that streaming leaves, as in CesiumJS issue 11952.
    """
    return mean(run["missing"])


@metric("quality", "ratio", "higher")
def optimality(run: MeasuredFrames) -> Statistic:
    """Benefit over the most that any selection of the same cost can have, where the log has it.

    Source: linear relaxation of the multiple-choice knapsack of Funkhouser and Séquin.
    """
    return ratio(run["benefit"], run["benefit_bound"])
