"""Lag metrics, and the answer to steps in load, worked by hand."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric_registry import find_metric
from lodbench.analysis.metrics.steps import find_steps
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]


def value(metric_id: str, log: FrameLog) -> float | None:
    """Return a metric of a log."""
    return find_metric(metric_id)(MeasuredFrames(log))


def test_lag_is_display_minus_input(make_log: MakeLog) -> None:
    """Frames sampled at 0, 10, 20 and shown at 25, 40, never: lags of 25 and 30 ms.

    The screen waited 25 ms for the first and 15 ms for the second.
    """
    log = make_log([25.0, 40.0, np.nan], input_ms=[0.0, 10.0, 20.0])
    assert value("lag_ms_mean", log) == pytest.approx((25 * 25 + 15 * 30) / 40)
    assert value("lag_ms_p99", log) == 30.0


def test_animation_error_is_the_difference_of_steps(make_log: MakeLog) -> None:
    """The world moves by 10 and 20 ms, the screen by 15 and 15: errors of -5 and +5, mean 5."""
    log = make_log([20.0, 35.0, 50.0], input_ms=[0.0, 10.0, 30.0])
    assert MeasuredFrames(log).animation_error_ms[1:].tolist() == pytest.approx([-5.0, 5.0])
    assert value("animation_error_ms_mean", log) == pytest.approx(5.0)


def test_animation_error_spans_dropped_frames(make_log: MakeLog) -> None:
    """Both steps are taken from the last frame that was shown."""
    log = make_log([20.0, np.nan, 50.0], input_ms=[0.0, 10.0, 30.0])
    assert value("animation_error_ms_mean", log) == pytest.approx(0.0)


def test_prediction_error_by_hand(make_log: MakeLog) -> None:
    """Predictions 10 % over and 20 % under: mean 15 without sign, deviation of +10 and -20."""
    log = make_log(gpu_ms=[10.0, 10.0, 5.0], predicted_gpu_ms=[11.0, 8.0, np.nan])
    assert value("prediction_error_pct_mean", log) == pytest.approx(15.0)
    assert value("prediction_error_pct_sd", log) == pytest.approx(30.0 / np.sqrt(2))


def test_policies_that_predict_nothing_have_no_prediction_error(make_log: MakeLog) -> None:
    """Without a prediction the metric is absent, not 0."""
    log = make_log(gpu_ms=[10.0, 10.0])
    assert value("prediction_error_pct_mean", log) is None
    assert value("prediction_error_pct_sd", log) is None


def step_log(make_log: MakeLog, work_ms: np.ndarray, budget_ms: float = 10.0) -> FrameLog:
    """Return 1 s of low load, then 3 s of high load, at a frame every 10 ms."""
    load = np.where(np.arange(len(work_ms)) < 100, 8.0, 40.0)
    return make_log(full_gpu_ms=load, gpu_ms=work_ms, cpu_ms=1.0, budget_ms=budget_ms)


def test_step_of_a_controller_that_settles(make_log: MakeLog) -> None:
    """Work falls from 35 ms by one a frame: within 1.1 times 10 ms after 24 frames, 240 ms."""
    work = np.full(400, 8.0)
    work[100:] = np.maximum(35.0 - np.arange(300), 9.0)
    (step,) = find_steps(MeasuredFrames(step_log(make_log, work)))
    assert (step.frame, step.time_ms) == (100, pytest.approx(1000.0))
    assert (step.load_before_ms, step.load_after_ms) == (8.0, 40.0)
    assert step.settled
    assert step.settle_ms == pytest.approx(240.0)
    assert step.overshoot_ratio == pytest.approx(3.5)


def test_step_that_is_never_settled_counts_to_the_end(make_log: MakeLog) -> None:
    """Without management the budget never holds again: 2,990 ms to the last frame's input."""
    work = np.where(np.arange(400) < 100, 8.0, 40.0)
    log = step_log(make_log, work)
    (step,) = find_steps(MeasuredFrames(log))
    assert not step.settled
    assert value("settle_ms", log) == pytest.approx(2990.0)
    assert value("overshoot_ratio", log) == pytest.approx(4.0)


def test_predicted_step_settles_at_once(make_log: MakeLog) -> None:
    """Work that never leaves the budget has settling time 0 and overshoot below 1."""
    log = step_log(make_log, np.full(400, 9.0))
    assert value("settle_ms", log) == 0.0
    assert value("overshoot_ratio", log) == pytest.approx(0.9)


def test_single_outliers_do_not_unsettle(make_log: MakeLog) -> None:
    """One frame in 25 over the band leaves the answer settled; one in five does not."""
    rare, often = np.full(400, 9.0), np.full(400, 9.0)
    rare[110::25] = 15.0
    often[100::5] = 15.0
    assert value("settle_ms", step_log(make_log, rare)) == 0.0
    (step,) = find_steps(MeasuredFrames(step_log(make_log, often)))
    assert not step.settled


def test_load_below_the_budget_is_no_step(make_log: MakeLog) -> None:
    """A rise that full detail would survive asks nothing of a policy: the metrics are absent."""
    log = step_log(make_log, np.full(400, 9.0), budget_ms=50.0)
    assert find_steps(MeasuredFrames(log)) == ()
    assert value("settle_ms", log) is None
    assert value("overshoot_ratio", log) is None


def test_slow_rise_is_no_step(make_log: MakeLog) -> None:
    """Load that doubles over two seconds rises by less than a quarter in any 100 ms."""
    load = np.concatenate((np.full(100, 20.0), np.linspace(20.0, 40.0, 200), np.full(100, 40.0)))
    log = make_log(full_gpu_ms=load, gpu_ms=9.0)
    assert find_steps(MeasuredFrames(log)) == ()


def test_two_steps_are_told_apart(make_log: MakeLog) -> None:
    """A second rise a second later is a step of its own, and ends the answer to the first."""
    load = np.repeat([8.0, 20.0, 40.0], 100)
    steps = find_steps(MeasuredFrames(make_log(full_gpu_ms=load, gpu_ms=load, budget_ms=10.0)))
    assert [step.frame for step in steps] == [100, 200]
    assert steps[0].settle_ms == pytest.approx(990.0)
    assert [step.overshoot_ratio for step in steps] == pytest.approx([2.0, 4.0])


def test_steps_are_the_same_at_any_frame_rate(make_log: MakeLog) -> None:
    """Sampled every 10 ms or every 35 ms, the same path has the same steps within a frame."""
    found: list[list[float]] = []
    for period_ms in (10.0, 35.0):
        time_ms = np.arange(0.0, 6000.0, period_ms)
        load = np.where((time_ms % 3000.0) < 1500.0, 8.0, 30.0)
        log = make_log(time_ms + 20.0, input_ms=time_ms, full_gpu_ms=load, gpu_ms=load)
        found.append([step.time_ms for step in find_steps(MeasuredFrames(log))])
    assert found[1] == pytest.approx(found[0], abs=35.0)
    assert len(found[0]) == 2
