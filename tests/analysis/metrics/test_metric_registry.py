"""The list of metrics, their records, and metrics that only sum or average a column."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric import GROUPS, Metric
from lodbench.analysis.metrics.metric_registry import METRICS, find_metric
from lodbench.base.errors import InputError
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]

IDS = {
    "stability": (
        *(
            f"{time}_ms_{s}"
            for time in ("frame", "work")
            for s in ("mean", "sd", "p50", "p95", "p99", "max")
        ),
        *("fps_low1_percentile", "fps_low1_mean", "fps_low1_integral", "hitches_per_min"),
        *("stutter_time_fraction", "over_budget_fraction", "over_budget_max_ratio"),
        *("longest_over_budget_frames", "missed_vsync_fraction", "frame_delta_ms_p95"),
        "utilisation",
    ),
    "lag": (
        *("lag_ms_mean", "lag_ms_p99", "animation_error_ms_mean", "settle_ms", "overshoot_ratio"),
        *("prediction_error_pct_mean", "prediction_error_pct_sd"),
    ),
    "flicker": ("toggles_per_frame", "reversals_per_frame", "popping_px_per_frame"),
    "quality": (
        *("sse_px_p95", "benefit_ratio", "degradation_mean", "missing_objects_per_frame"),
        "optimality",
    ),
    "work": (
        *("select_ms_mean", "select_ms_p99", "levels_extracted_per_frame"),
        *("levels_borrowed_per_frame", "triangles_mean", "memory_peak_fraction"),
    ),
}


def value(metric_id: str, log: FrameLog) -> float | None:
    """Return a metric of a log."""
    return find_metric(metric_id).value(MeasuredFrames(log))


@pytest.mark.parametrize("group", GROUPS)
def test_ids_are_those_of_the_contract(group: str) -> None:
    """Every id that the comparison promises exists, in its group and in this order."""
    ids = [metric.id for metric in METRICS if metric.group == group]
    assert tuple(name for name in ids if name in IDS[group]) == IDS[group]


def test_groups_stand_together() -> None:
    """Tables begin a section where the group changes, so that each group is one section."""
    groups = [metric.group for metric in METRICS]
    assert sorted(groups, key=GROUPS.index) == groups
    assert len({metric.id for metric in METRICS}) == len(METRICS)


@pytest.mark.parametrize("metric", METRICS, ids=lambda metric: metric.id)
def test_records_are_complete(metric: Metric) -> None:
    """Every metric has a definition in sentences, a source, a unit and a direction."""
    assert metric.definition.endswith(".")
    assert metric.source.endswith(".")
    assert metric.unit
    assert metric.better in ("lower", "higher")


def test_unknown_metric_suggests_the_nearest() -> None:
    """A misspelt id is refused with the id that was meant."""
    with pytest.raises(InputError, match="did you mean toggles_per_frame"):
        find_metric("toggles_per_frames")


def test_warmup_must_leave_frames(make_log: MakeLog) -> None:
    """A warm-up as long as the run is refused, with what to do."""
    with pytest.raises(InputError, match=r"fewer frames than the 3.*--warmup"):
        MeasuredFrames(make_log(gpu_ms=np.ones(3)), 3)


def test_flicker_counts_by_hand(make_log: MakeLog) -> None:
    """Toggles, reversals and popping are means over frames."""
    log = make_log(toggles=[4, 0, 2], reversals=[1, 0, 0], popping_px=[0.5, 0.0, 1.0])
    assert value("toggles_per_frame", log) == pytest.approx(2.0)
    assert value("reversals_per_frame", log) == pytest.approx(1 / 3)
    assert value("popping_px_per_frame", log) == pytest.approx(0.5)


def test_quality_by_hand(make_log: MakeLog) -> None:
    """Benefit and degradation are sum over sum; a frame that draws nothing has no error."""
    log = make_log(
        benefit=[3.0, 5.0],
        full_benefit=[4.0, 12.0],
        benefit_bound=[4.0, 6.0],
        degradation=[2.0, 4.0],
        full_degradation=[1.0, 3.0],
        drawn=[10, 0],
        sse_px_p95=[1.5, 0.0],
        missing=[0, 3],
    )
    assert value("benefit_ratio", log) == pytest.approx(0.5)
    assert value("optimality", log) == pytest.approx(0.8)
    assert value("degradation_mean", log) == pytest.approx(1.5)
    assert value("sse_px_p95", log) == pytest.approx(1.5)
    assert value("missing_objects_per_frame", log) == pytest.approx(1.5)


def test_nothing_visible_has_no_ratio(make_log: MakeLog) -> None:
    """Where no benefit was to be had, the share of it is absent, not 0 and not a division error."""
    log = make_log(gpu_ms=np.ones(4))
    assert value("benefit_ratio", log) is None
    assert value("sse_px_p95", log) is None


def test_work_by_hand(make_log: MakeLog) -> None:
    """Selection time, extraction, triangles and memory are means and maxima of their columns."""
    log = make_log(
        select_ms=[0.1, 0.3],
        levels_extracted=[2, 0],
        levels_borrowed=[0, 1],
        triangles=[1000, 3000],
        memory_bytes=[100.0, 250.0],
        memory_bound_bytes=1000.0,
    )
    expected = {
        "select_ms_mean": 0.2,
        "select_ms_p99": 0.298,
        "levels_extracted_per_frame": 1.0,
        "levels_borrowed_per_frame": 0.5,
        "triangles_mean": 2000.0,
        "memory_peak_fraction": 0.25,
    }
    for metric_id, truth in expected.items():
        assert value(metric_id, log) == pytest.approx(truth), metric_id


def test_what_a_run_cannot_have_is_absent(make_log: MakeLog) -> None:
    """Discrete levels, no prediction, no refresh, no steps and no bound give no values."""
    log = make_log(np.arange(50) * 10.0 + 15.0, gpu_ms=np.full(50, 5.0))
    absent = {
        metric.id
        for metric in METRICS
        if metric.group != "quality" and metric.value(MeasuredFrames(log)) is None
    }
    assert absent == {
        "missed_vsync_fraction",
        "settle_ms",
        "overshoot_ratio",
        "prediction_error_pct_mean",
        "prediction_error_pct_sd",
        "levels_extracted_per_frame",
        "levels_borrowed_per_frame",
    }
    assert value("optimality", log) is None
