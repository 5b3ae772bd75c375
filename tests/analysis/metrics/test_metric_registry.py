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
    "budget": (
        *("over_budget_time_fraction", "work_ms_mean", "work_ms_p50", "work_ms_p95"),
        *("work_ms_p99", "work_ms_max", "over_budget_max_ratio", "longest_over_budget_ms"),
        "utilisation",
    ),
    "stability": (
        *(f"frame_ms_{s}" for s in ("mean", "sd", "p50", "p95", "p99", "max")),
        *("fps_low1_percentile", "fps_low1_mean", "fps_low1_integral", "hitches_per_min"),
        *("stutter_time_fraction", "missed_vsync_fraction", "frame_delta_ms_p95"),
    ),
    "lag": (
        *("lag_ms_mean", "lag_ms_p99", "animation_error_ms_mean", "settle_ms", "overshoot_ratio"),
        *("prediction_error_pct_mean", "prediction_error_pct_sd"),
    ),
    "flicker": ("visible_pops_per_s", "toggles_per_s", "reversals_per_s", "popping_px_per_s"),
    "quality": (
        *("visible_error_px", "visible_error_area_px", "sse_px_p95", "sse_px_worst"),
        *("benefit_ratio", "degradation_mean", "missing_objects_mean", "optimality"),
    ),
    "work": (
        *("select_ms_mean", "select_ms_p99", "levels_changed_per_s", "levels_borrowed_per_s"),
        *("triangles_mean", "memory_peak_fraction"),
    ),
}


def value(metric_id: str, log: FrameLog, end_s: float | None = None) -> float | None:
    """Return a metric of a log."""
    return find_metric(metric_id)(MeasuredFrames(log, 0.0, end_s))


@pytest.mark.parametrize("group", GROUPS)
def test_ids_are_those_of_the_contract(group: str) -> None:
    """The ids are those that the comparison promises, in their groups and in this order."""
    ids = [metric.id for metric in METRICS if metric.group == group]
    assert tuple(ids) == IDS[group]


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
    with pytest.raises(InputError, match="did you mean toggles_per_s"):
        find_metric("toggles_per_ss")


def test_flicker_counts_by_hand(make_log: MakeLog) -> None:
    """Events of all frames over the half second of the window, however many frames it has."""
    log = make_log(
        toggles=[4, 0, 2], visible_pops=[1, 0, 2], reversals=[1, 0, 0], popping_px=[0.5, 0.0, 1.0]
    )
    assert value("toggles_per_s", log, 0.5) == pytest.approx(12.0)
    assert value("visible_pops_per_s", log, 0.5) == pytest.approx(6.0)
    assert value("reversals_per_s", log, 0.5) == pytest.approx(2.0)
    assert value("popping_px_per_s", log, 0.5) == pytest.approx(3.0)


def test_quality_by_hand(make_log: MakeLog) -> None:
    """Pictures count for 10, 30 and 60 ms; one that draws nothing has no error."""
    log = make_log(
        [10.0, 20.0, 50.0],
        benefit=[3.0, 5.0, 2.0],
        full_benefit=[4.0, 12.0, 2.0],
        benefit_bound=[4.0, 6.0, np.nan],
        degradation=[2.0, 4.0, 1.0],
        full_degradation=[1.0, 3.0, 1.0],
        drawn=[10, 10, 0],
        sse_px_p95=[1.5, 0.9, 0.0],
        sse_px_max=[2.0, 7.0, 9.0],
        visible_error_area_px=[0.4, 0.0, 0.0],
        missing=[0, 3, 1],
    )
    expected = {
        "benefit_ratio": (10 * 3 + 30 * 5 + 60 * 2) / (10 * 4 + 30 * 12 + 60 * 2),
        "optimality": (10 * 3 + 30 * 5) / (10 * 4 + 30 * 6),
        "degradation_mean": (10 * 2 + 30 * 4 + 60 * 1) / (10 * 1 + 30 * 3 + 60 * 1),
        "sse_px_p95": (10 * 1.5 + 30 * 0.9) / 40,
        "sse_px_worst": 7.0,
        "visible_error_px": 10 * 0.5 / 40,
        "visible_error_area_px": 10 * 0.4 / 40,
        "missing_objects_mean": (30 * 3 + 60 * 1) / 100,
    }
    for metric_id, truth in expected.items():
        assert value(metric_id, log, 0.11) == pytest.approx(truth), metric_id


def test_nothing_visible_has_no_ratio(make_log: MakeLog) -> None:
    """Where no benefit was to be had, the share of it is absent, not 0 and not a division error."""
    log = make_log(gpu_ms=np.ones(4))
    assert value("benefit_ratio", log) is None
    assert value("sse_px_p95", log) is None


def test_work_by_hand(make_log: MakeLog) -> None:
    """Selection time and triangles are means over 10 and 30 ms, levels are of 40 ms."""
    log = make_log(
        [10.0, 40.0],
        select_ms=[0.1, 0.3],
        levels_extracted=[2, 0],
        levels_borrowed=[0, 1],
        triangles=[1000, 3000],
        memory_bytes=[100.0, 250.0],
        memory_bound_bytes=1000.0,
    )
    expected = {
        "select_ms_mean": 0.25,
        "select_ms_p99": 0.3,
        "levels_changed_per_s": 50.0,
        "levels_borrowed_per_s": 25.0,
        "triangles_mean": 2500.0,
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
        if metric.group != "quality" and metric(MeasuredFrames(log)) is None
    }
    assert absent == {
        "missed_vsync_fraction",
        "settle_ms",
        "overshoot_ratio",
        "prediction_error_pct_mean",
        "prediction_error_pct_sd",
        "levels_changed_per_s",
        "levels_borrowed_per_s",
    }
    assert value("optimality", log) is None
