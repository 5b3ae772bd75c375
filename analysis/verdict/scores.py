"""The metrics of a judged policy, each with its intervals and their populations."""

import numpy as np

from ...base.arrays import FloatArray
from ..metrics.metric import Metric
from ..metrics.metric_registry import METRICS
from ..study.comparison_parts import Score, Span
from .intervals import Interval, such_paths, this_path, with_machine
from .judged import Judged
from .metric_kinds import kind_of

LEVEL = 0.9


def score_metrics(judged: Judged) -> dict[str, Score]:
    """Return every metric of a policy."""
    return {metric.id: _score(metric, judged) for metric in METRICS}


def _score(metric: Metric, judged: Judged) -> Score:
    values = judged.values(metric.id)
    unit, better = metric.unit, metric.better
    kind = kind_of(metric)
    if np.isnan(values).all():
        return Score(None, None, None, None, False, None, unit, better)
    if kind == "extreme":
        worst = np.nanmax(values) if better == "lower" else np.nanmin(values)
        return Score(float(worst), None, None, None, False, None, unit, better)
    # A path without the metric, such as one without a step in load, says nothing of its mean.
    known = values[~np.isnan(values).any(axis=1)]
    if not len(known):
        value = float(np.nanmean(values))
        return Score(value, None, None, None, False, None, unit, better)
    over_seeds = this_path(known, LEVEL)
    paths = such_paths(known.mean(axis=1), kind, LEVEL) if len(known) > 1 else None
    drawn = judged.drawn_values(metric.id)
    machine = None
    if len(drawn) > 1 and len(known) > 1 and not np.isnan(drawn).any():
        machine = with_machine(known.mean(axis=1), drawn, kind, LEVEL)
    return Score(
        value=float(known.mean()),
        this_path=_span(over_seeds, known),
        such_paths=_span(paths, known),
        with_machine=_span(machine, known),
        enough=paths is not None and paths.enough,
        needed=None if paths is None else paths.needed,
        unit=unit,
        better=better,
    )


def _span(interval: Interval | None, values: FloatArray) -> Span | None:
    """Return the ends of an interval, None where the runs are too few for one."""
    if interval is None or np.isnan(interval.low) or np.isnan(interval.high):
        return None
    low, high = interval.low, interval.high
    return (low, high) if (values < 0.0).any() else (max(low, 0.0), high)
