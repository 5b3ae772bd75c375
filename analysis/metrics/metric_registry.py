"""All metrics, in the order in which tables show them."""

from importlib import import_module

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from .metric import GROUPS, Metric

_MODULES = ("budget", "stability", "lag", "flicker", "quality", "work")

_CONTENTS = [vars(import_module(f".{module}", __package__)) for module in _MODULES]
METRICS: tuple[Metric, ...] = tuple(
    item
    for group in GROUPS
    for content in _CONTENTS
    for item in content.values()
    if isinstance(item, Metric) and item.group == group
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
