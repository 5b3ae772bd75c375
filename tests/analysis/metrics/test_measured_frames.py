"""The window of the path, what frames weigh in it, and that frame rates do not decide."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric_registry import METRICS, find_metric
from lodbench.analysis.metrics.over_time import time_mean, time_quantile
from lodbench.base.errors import InputError
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]


def test_weights_by_hand(make_log: MakeLog) -> None:
    """Of displays at 15, 35 and 65 ms, pictures stay 20, 30 and 35 ms to the end at 100 ms.

    The screen waited for them 15 (from the first input sample), 20 and 30 ms.
    """
    run = MeasuredFrames(make_log([15.0, 35.0, 65.0], input_ms=[0.0, 10.0, 30.0]), 0.0, 0.1)
    assert run.picture_weight_ms.tolist() == pytest.approx([20.0, 30.0, 35.0])
    assert run.cost_weight_ms.tolist() == pytest.approx([15.0, 20.0, 30.0])


def test_window_is_of_input_samples_and_clips_intervals(make_log: MakeLog) -> None:
    """From 10 to 60 ms two frames were begun; the last is on the screen from 35 ms on."""
    log = make_log([5.0, 15.0, 35.0, 65.0], input_ms=[0.0, 10.0, 30.0, 61.0])
    run = MeasuredFrames(log, 0.01, 0.06)
    assert (len(run), run.first) == (2, 1)
    assert run.picture_weight_ms.tolist() == pytest.approx([20.0, 25.0])
    assert run.cost_weight_ms.tolist() == pytest.approx([5.0, 20.0])


def test_frames_never_shown_share_the_wait_and_have_no_picture(make_log: MakeLog) -> None:
    """Two frames that mailbox replaced and the one after them: 30 ms in equal parts."""
    log = make_log([10.0, np.nan, np.nan, 40.0], input_ms=[0.0, 8.0, 16.0, 24.0], mode="mailbox")
    run = MeasuredFrames(log, 0.0, 0.05)
    assert run.cost_weight_ms.tolist() == pytest.approx([10.0, 10.0, 10.0, 10.0])
    assert run.picture_weight_ms.tolist() == pytest.approx([30.0, 0.0, 0.0, 10.0])


@st.composite
def replays(draw: st.DrawFn) -> tuple[list[float], list[float], int, int]:
    """Draw inputs, displays (NaN if dropped) and a window, all in whole milliseconds."""
    steps = draw(st.lists(st.integers(1, 30), min_size=2, max_size=25))
    inputs = np.cumsum(steps) - steps[0]
    lags = draw(st.lists(st.integers(1, 40), min_size=len(steps), max_size=len(steps)))
    shown = np.maximum.accumulate(inputs + lags) + np.arange(len(steps))
    hidden = draw(st.lists(st.booleans(), min_size=len(steps) - 1, max_size=len(steps) - 1))
    displays = np.where([*hidden, False], np.nan, shown)
    start = draw(st.integers(0, int(inputs[-1])))
    end = draw(st.integers(start + 1, int(inputs[-1]) + 60))
    return inputs.tolist(), displays.tolist(), start, end


@given(replays())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
def test_weights_are_those_of_a_watcher(
    make_log: MakeLog, replay: tuple[list[float], list[float], int, int]
) -> None:
    """A watcher who looks once a millisecond finds the same weights, and none is lost.

    Pictures begin with the first measured one and cover the window to its end; the screen waits for
    some frame at any time until the last display.
    """
    inputs, displays, start, end = replay
    measured = [i for i, at in enumerate(inputs) if start <= at <= end]
    log = make_log(displays, input_ms=inputs)
    if not measured:
        with pytest.raises(InputError, match="none of"):
            MeasuredFrames(log, start * 1e-3, end * 1e-3)
        return
    run = MeasuredFrames(log, start * 1e-3, end * 1e-3)
    picture, cost = np.zeros(len(inputs)), np.zeros(len(inputs))
    shown = [i for i, at in enumerate(displays) if not np.isnan(at)]
    for tick in range(start, end):
        on_screen = [i for i in shown if displays[i] <= tick]
        if on_screen:
            picture[on_screen[-1]] += 1.0
        awaited = [i for i in shown if displays[i] > tick]
        if awaited:
            group = range(on_screen[-1] + 1 if on_screen else 0, awaited[0] + 1)
            cost[list(group)] += 1.0 / len(group)
    assert run.picture_weight_ms == pytest.approx(picture[measured])
    assert run.cost_weight_ms == pytest.approx(cost[measured])
    assert picture.sum() == max(end - max(displays[shown[0]], start), 0)
    assert cost.sum() == pytest.approx(max(min(displays[shown[-1]], end) - start, 0))


@pytest.mark.parametrize("window_s", [(1.0, 1.0), (-0.1, 1.0), (2.0, 1.0), (np.nan, 1.0)])
def test_empty_windows_are_refused(make_log: MakeLog, window_s: tuple[float, float]) -> None:
    """A warm-up that leaves nothing of the path is told with the path's length."""
    with pytest.raises(InputError, match=r"warmup: expected seconds >= 0 and less than"):
        MeasuredFrames(make_log(gpu_ms=np.ones(300)), *window_s)


def test_a_window_without_a_frame_is_refused(make_log: MakeLog) -> None:
    """A replay of two frames, both begun in the warm-up, has nothing that counts."""
    log = make_log([900.0, 5000.0], input_ms=[0.0, 900.0])
    with pytest.raises(InputError, match=r"begins in 1 to 4 s of the path, got none of 2"):
        MeasuredFrames(log, 1.0, 4.0)


def stop_and_go(make_log: MakeLog) -> tuple[FrameLog, FrameLog]:
    """Return two replays of one second: 10 ms frames of 9 ms work, and one that stalls.

    It has 10 ms frames of 1 ms work for 0.52 s, then 12 frames of 40 ms.
    """
    steady = np.arange(100) * 10.0
    slow = np.concatenate((np.arange(52) * 10.0, 520.0 + np.arange(12) * 40.0))
    took = np.where(np.arange(64) < 52, 10.0, 40.0)
    work = np.where(np.arange(64) < 52, 1.0, 40.0)
    error = np.where(np.arange(64) < 52, 0.5, 6.0)
    common = {"budget_ms": 16.0, "drawn": 1.0}
    return (
        make_log(steady + 10.0, input_ms=steady, cpu_ms=9.0, sse_px_p95=2.0, **common),
        make_log(slow + took, input_ms=slow, cpu_ms=work, sse_px_p95=error, **common),
    )


def test_the_order_is_that_of_time_and_not_of_frames(make_log: MakeLog) -> None:
    """The one that stalls has the lower mean over frames, and the higher over time, as a user sees.

    Over frames its work is (52 · 1 + 12 · 40) / 64 = 8.3 ms against 9; over time .52 · 1 + .48 · 40
    = 19.7 ms.  It is over the budget in 12 of 64 frames and 48 % of the time.
    """
    steady, stalls = (MeasuredFrames(log, 0.0, 1.0) for log in stop_and_go(make_log))
    assert stalls.work_ms.mean() == pytest.approx(8.3125)
    assert stalls.work_ms.mean() < steady.work_ms.mean()
    mean = find_metric("work_ms_mean")
    assert mean(stalls) == pytest.approx(0.52 * 1.0 + 0.48 * 40.0)
    assert mean(steady) == pytest.approx(9.0)
    assert find_metric("over_budget_time_fraction")(stalls) == pytest.approx(0.48)
    assert find_metric("longest_over_budget_ms")(stalls) == pytest.approx(480.0)
    # Half of the time holds at 1 ms; the frames' median is there too, the 60th percentile is not.
    assert time_quantile(stalls.work_ms, stalls.cost_weight_ms, 0.52) == 1.0
    assert time_quantile(stalls.work_ms, stalls.cost_weight_ms, 0.53) == 40.0
    # The last coarse picture stays until the first slow frame comes at 560 ms, and the last slow
    # one comes only at the end.
    assert find_metric("sse_px_p95")(stalls) == pytest.approx((550.0 * 0.5 + 440.0 * 6.0) / 990.0)
    assert find_metric("sse_px_p95")(steady) == pytest.approx(2.0)


def test_the_same_world_at_two_frame_rates_has_the_same_scores(make_log: MakeLog) -> None:
    """Work and error that rise along the path, sampled every 10 or 40 ms: equal within a frame.

    A rate of events a second does not depend on the frame rate either.
    """
    found: list[dict[str, float | None]] = []
    for step_ms in (10.0, 40.0):
        at = np.arange(0.0, 10_000.0, step_ms)
        log = make_log(
            at + step_ms,
            input_ms=at,
            cpu_ms=5.0 + at * 1e-3,
            sse_px_p95=at * 1e-3,
            drawn=1.0,
            toggles=np.where(at % 400.0 == 0.0, 8.0, 0.0),
            select_ms=at * 1e-4,
        )
        run = MeasuredFrames(log, 1.0, 10.0)
        found.append({metric.id: metric(run) for metric in METRICS})
    for name in (
        *("work_ms_mean", "work_ms_p50", "work_ms_p95", "over_budget_time_fraction"),
        *("utilisation", "sse_px_p95", "visible_error_px", "toggles_per_s", "select_ms_mean"),
    ):
        assert found[0][name] == pytest.approx(found[1][name], rel=0.02), name
        assert found[0][name], name


def test_a_quantile_over_time_is_that_of_whole_milliseconds(make_log: MakeLog) -> None:
    """The quantile is that of the values written out once a millisecond, the least with a share."""
    values = np.array([3.0, 9.0, 1.0, 7.0, 5.0])
    weight = np.array([4.0, 1.0, 10.0, 0.0, 5.0])
    ticks = np.repeat(values, weight.astype(int))
    for q in (0.01, 0.25, 0.5, 0.51, 0.7, 0.71, 0.94, 0.96, 1.0):
        truth = float(np.quantile(ticks, q, method="inverted_cdf"))
        assert time_quantile(values, weight, q) == truth, q
    assert time_mean(values, weight) == pytest.approx(ticks.mean())


def test_what_weighs_nothing_has_no_mean() -> None:
    """Without a value that weighs there is no mean and no quantile, rather than 0 or NaN."""
    nan, one = np.array([np.nan, 2.0]), np.array([1.0, 0.0])
    assert time_mean(nan, one) is None
    assert time_quantile(nan, one, 0.5) is None
