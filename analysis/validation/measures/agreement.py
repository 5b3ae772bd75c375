"""Metrics measured against where one more recording would lie, as the simulation has it."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ...metrics.metric_registry import METRICS
from ..validation_result import Agreement, Inside, PolicyValidation

COUNTED = (
    "over_budget_time_fraction",
    "frame_ms_mean",
    "frame_ms_sd",
    "frame_ms_p99",
    "frame_delta_ms_p95",
    "lag_ms_mean",
    "prediction_error_pct_mean",
    "visible_pops_per_s",
    "toggles_per_s",
    "reversals_per_s",
    "popping_px_per_s",
    "sse_px_p95",
    "benefit_ratio",
    "triangles_mean",
)
"""Metrics whose share inside is given: each says something that no other of them says.

The rest are these in other words: ``work_ms`` is ``frame_ms`` of a machine that does nothing
beside the frame, ``fps_low1`` is 1000 over a percentile, ``utilisation`` a mean over the budget;
and extremes, which one spike decides.  With one frame in flight and no screen to wait for, lag is
frame time digit for digit, so that it counts only where frames are drawn deeper.
"""


def predictive_interval(
    values: Sequence[float | None], level: float
) -> tuple[float, float] | tuple[None, None]:
    """Return where one more value lies with a probability of `level`, if it is as these are.

    Nothing if one is missing, or they are too few.  Order statistics at ranks (n + 1) p: exact for
    exchangeable values of any distribution.

    Source: Hahn and Meeker, Statistical Intervals (1991), section 5.4.
    """
    known = [value for value in values if value is not None]
    if len(known) < len(values) or len(known) + 1 < round(2.0 / (1.0 - level), 9):
        return None, None
    ends = ((1.0 - level) / 2.0, (1.0 + level) / 2.0)
    low, high = np.quantile(known, ends, method="weibull").tolist()
    return low, high


def agree(
    measured: Sequence[Mapping[str, float | None]],
    replicates: Sequence[Mapping[str, float | None]],
    level: float,
    frames_in_flight: int,
) -> dict[str, Agreement]:
    """Return how each metric of one or two recordings stands to the replicates of them."""
    found: dict[str, Agreement] = {}
    for metric in METRICS:
        value = measured[0][metric.id]
        again = measured[1][metric.id] if len(measured) > 1 else None
        simulated = [run[metric.id] for run in replicates]
        known = [each for each in simulated if each is not None]
        low, high = predictive_interval(simulated, level)
        inside = None
        if value is not None and low is not None and high is not None:
            # Sums over frames in another order differ by rounding.
            slack = 1e-9 * max(abs(low), abs(high))
            inside = low - slack <= value <= high + slack
        counted = (
            metric.id in COUNTED
            and inside is not None
            and (metric.id != "lag_ms_mean" or frames_in_flight > 1)
            # Full detail never switches, here as there: that tells nothing.
            and not (inside and low == high)
        )
        middle = float(np.median(known)) if known else None
        found[metric.id] = Agreement(value, again, middle, low, high, inside, counted, metric.unit)
    return found


def share_inside(policies: Iterable[PolicyValidation]) -> Inside:
    """Return how many of the counted metrics are inside, over policies."""
    by_metric: dict[str, tuple[int, int]] = {}
    for policy in policies:
        for name, item in policy.metrics.items():
            if item.counted:
                inside, of = by_metric.get(name, (0, 0))
                by_metric[name] = inside + bool(item.inside), of + 1
    inside, of = (
        (sum(column) for column in zip(*by_metric.values(), strict=True)) if by_metric else (0, 0)
    )
    return Inside(inside, of, by_metric)
