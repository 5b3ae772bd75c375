"""How a metric varies over paths, which decides its interval."""

from typing import Literal

from ..metrics.metric import Metric

Kind = Literal["positive", "share", "signed", "capped", "extreme"]
"""positive: never negative, skewed upwards.  share: of time or frames, in [0, 1], often 0.
signed: of either sign, or nearly symmetric.  capped: at its best on most paths, as a rate that the
display bounds, and below on some.  extreme: a maximum, shown as observed."""

_EXTREMES = frozenset(
    {
        "longest_over_budget_frames",
        "longest_over_budget_ms",
        "memory_peak_fraction",
        "over_budget_max_ratio",
        "sse_px_worst",
    }
)
_EXTREME_ENDINGS = ("_max", "_worst", "_peak")
_NEAR_ONE = frozenset({"benefit_ratio", "optimality", "utilisation"})  # skewed downwards, if at all


def kind_of(metric: Metric) -> Kind:
    """Return how a metric varies over paths, by its id, else by its unit."""
    if metric.id in _EXTREMES or metric.id.endswith(_EXTREME_ENDINGS):
        return "extreme"
    if metric.id in _NEAR_ONE:
        return "signed"
    if metric.unit == "fps":
        return "capped"
    return "share" if metric.unit == "fraction" else "positive"
