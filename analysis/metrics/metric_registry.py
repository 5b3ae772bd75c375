"""All metrics, in the order in which tables show them."""

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
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
    advice = "see `lodbench list metrics`"
    raise InputError(f"metric: {unknown_name(metric_id, _BY_ID, advice=advice)}")
