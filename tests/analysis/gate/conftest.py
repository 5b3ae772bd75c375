"""Measurements made by hand: any values of a metric, by path and seed."""

from collections.abc import Callable, Sequence

import pytest

from lodbench.analysis.gate.measurements import Conditions, MeasuredPolicy
from lodbench.analysis.metrics.footing import Footing
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.worst_moment import Moment
from lodbench.analysis.study.score import Scored

Rows = Sequence[Sequence[float | None]]
Make = Callable[..., MeasuredPolicy]


@pytest.fixture
def conditions() -> Conditions:
    """Return a budget of 10 ms at 50 Hz."""
    return Conditions(
        hardware="machine",
        display="vsync",
        refresh_hz=50.0,
        frames_in_flight=2,
        pacing="none",
        latency_limit=0,
        budget_ms=10.0,
        seed=0,
        seeds=2,
        warmup_s=1.0,
        visible_px=1.0,
    )


@pytest.fixture
def make_measured() -> Make:
    """Return a builder of measurements in which a metric has these values, and others have none."""

    def make(
        rows: Rows,
        metric: str = "work_ms_p99",
        *,
        policy: str = "pid",
        full_ms: float = 40.0,
        empty: float = 0.0,
    ) -> MeasuredPolicy:
        names = tuple(f"walk-{at}" for at in range(len(rows)))
        runs = tuple(
            tuple(_scored(name, metric, value, full_ms, empty) for value in row)
            for name, row in zip(names, rows, strict=True)
        )
        return MeasuredPolicy(policy, "yard", names, names, runs)

    return make


def _scored(path: str, metric: str, value: float | None, full_ms: float, empty: float) -> Scored:
    values: dict[str, float | None] = {item.id: None for item in METRICS}
    assert metric in values
    return Scored(
        log=None,
        values=values | {metric: value},
        steps=(),
        frames=100,
        judged_ms=8.0,
        worst=Moment(path, 2.5, (1.0, -2.0, 1.65), 24.0, 8.0, "triangles", 11.0),
        footing=Footing(full_ms, empty),
    )
