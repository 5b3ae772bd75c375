"""Whether a run can tell policies apart: what there is to see, and what full detail would cost."""

from dataclasses import dataclass

from .measured_frames import MeasuredFrames
from .over_time import time_quantile


@dataclass(frozen=True, slots=True)
class Footing:
    """What no policy decides about a window.

    Attributes
    ----------
    full_gpu_ms : float
        Time-weighted quantile of the noise-free GPU time that full detail would take.
    empty_fraction : float
        Share of the window's time in which nothing is in view.
    """

    full_gpu_ms: float
    empty_fraction: float


def find_footing(frames: MeasuredFrames, quantile: float) -> Footing:
    """Return the footing of a run, at the quantile of time that a budget is judged by."""
    weight = frames.picture_weight_ms
    total = float(weight.sum())
    empty = float(weight[frames["visible"] == 0.0].sum()) / total if total > 0.0 else 0.0
    full = time_quantile(frames["full_gpu_ms"], frames.cost_weight_ms, quantile)
    return Footing(0.0 if full is None else full, empty)
