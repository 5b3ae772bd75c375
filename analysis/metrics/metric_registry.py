"""All metrics, in the order in which tables show them."""

import difflib

from ...base.errors import InputError
from . import flicker, lag, quality, stability, work
from .metric import Metric

METRICS: tuple[Metric, ...] = tuple(
    item
    for module in (stability, lag, flicker, quality, work)
    for item in vars(module).values()
    if isinstance(item, Metric)
)
_BY_ID = {metric.id: metric for metric in METRICS}


def find_metric(metric_id: str) -> Metric:
    """Return the metric of an id.

    Raises `InputError` if there is none, with the nearest id.
    """
    if metric_id in _BY_ID:
        return _BY_ID[metric_id]
    near = difflib.get_close_matches(metric_id, _BY_ID, n=1)
    hint = f"did you mean {near[0]}?" if near else "see `lodbench list metrics`"
    raise InputError(f"metric: expected one of the {len(_BY_ID)} ids, got {metric_id}; {hint}")
