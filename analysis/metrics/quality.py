"""Quality: how much of full detail is shown, each picture for as long as it is on the screen."""

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from .measured_frames import MeasuredFrames
from .metric import metric
from .over_frames import most
from .over_time import time_mean, time_ratio


@metric("quality", "px", "lower")
def visible_error_px(run: MeasuredFrames) -> float | None:
    """Mean over time of what sse_px_p95 has beyond the least visible error (`--visible`).

    A percentile of what is beyond a threshold is what the percentile is beyond it.

    Source: lodbench; the threshold of 1 px is that of meshoptimizer, Godot and Nanite's authors.
    """
    return _picture_mean(run, np.maximum(run["sse_px_p95"] - run.header.visible_px, 0.0))


@metric("quality", "px", "lower")
def visible_error_area_px(run: MeasuredFrames) -> float | None:
    """Mean over time, and over nodes by their area on the screen, of what is visible.

    Source: as visible_error_px; by area, many small nodes do not outvote the large ones.
    """
    return _picture_mean(run, run["visible_error_area_px"])


@metric("quality", "px", "lower")
def sse_px_p95(run: MeasuredFrames) -> float | None:
    """Mean over time of the 95th percentile, over nodes, of projected geometric error.

    What is missing errs by the diameter of its bounding sphere.

    Source: screen-space error of CesiumJS, error · height / (distance · 2 tan(fovy / 2)).
    """
    return _picture_mean(run, run["sse_px_p95"])


@metric("quality", "px", "lower")
def sse_px_worst(run: MeasuredFrames) -> float | None:
    """Largest projected geometric error of a node in any picture shown, as observed.

    Source: as sse_px_p95.
    """
    return most(np.where(_pictured(run), run["sse_px_max"], np.nan))


@metric("quality", "ratio", "higher")
def benefit_ratio(run: MeasuredFrames) -> float | None:
    """Benefit of what was shown over the benefit of full detail, integral over integral.

    Source: Benefit of Funkhouser and Séquin, SIGGRAPH 1993.
    """
    return time_ratio(run["benefit"], run["full_benefit"], run.picture_weight_ms)


@metric("quality", "ratio", "lower")
def degradation_mean(run: MeasuredFrames) -> float | None:
    """Degradation of what was shown over that of full detail, as benefit_ratio; 1 at full detail.

    Source: Degradation of Gobbetti and Bouvier, Time-critical multiresolution rendering of large
    complex models.
    """
    return time_ratio(run["degradation"], run["full_degradation"], run.picture_weight_ms)


@metric("quality", "nodes", "lower")
def missing_objects_mean(run: MeasuredFrames) -> float | None:
    """Mean over time of the candidates in the frustum of which nothing was drawn.

    Source: lodbench; holes that streaming leaves, as in CesiumJS issue 11952.
    """
    return time_mean(run["missing"], run.picture_weight_ms)


@metric("quality", "ratio", "higher")
def optimality(run: MeasuredFrames) -> float | None:
    """Benefit over the most that any selection of the same cost can have, where the log has it.

    Source: linear relaxation of the multiple-choice knapsack of Funkhouser and Séquin.
    """
    return time_ratio(run["benefit"], run["benefit_bound"], run.picture_weight_ms)


def _pictured(run: MeasuredFrames) -> BoolArray:
    return (run["drawn"] > 0.0) & run.shown


def _picture_mean(run: MeasuredFrames, error_px: FloatArray) -> float | None:
    """Return the mean over time of pictures that show anything: an empty one has no error."""
    return time_mean(np.where(_pictured(run), error_px, np.nan), run.picture_weight_ms)
