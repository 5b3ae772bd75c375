"""Which interval a metric has."""

import pytest

from lodbench.analysis.metrics.metric import Metric
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.verdict.metric_kinds import Kind, kind_of


def named(metric_id: str, unit: str) -> Metric:
    """Return a metric that nobody measures."""
    return Metric(metric_id, "stability", unit, "lower", "", "", lambda run: None)


@pytest.mark.parametrize(
    ("metric_id", "unit", "kind"),
    [
        ("over_budget_time_fraction", "fraction", "share"),
        ("memory_peak_fraction", "fraction", "extreme"),
        ("work_ms_max", "ms", "extreme"),
        ("over_budget_max_ratio", "ratio", "extreme"),
        ("sse_px_worst", "px", "extreme"),
        ("longest_over_budget_ms", "ms", "extreme"),
        ("work_ms_p99", "ms", "positive"),
        ("visible_error_px", "px", "positive"),
        ("overshoot_ratio", "ratio", "positive"),
        ("optimality", "ratio", "signed"),
        ("fps_low1_mean", "fps", "capped"),
    ],
)
def test_kinds_by_name(metric_id: str, unit: str, kind: Kind) -> None:
    """Shares of time by their unit, extremes by their name, the rest skewed upwards."""
    assert kind_of(named(metric_id, unit)) == kind


def test_every_largest_and_longest_is_an_extreme() -> None:
    """A metric that its definition calls the largest or longest has no interval of its mean."""
    for metric in METRICS:
        if metric.definition.startswith(("Largest", "Longest")):
            assert kind_of(metric) == "extreme", metric.id
