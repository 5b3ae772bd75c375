"""Stability metrics on frame times worked by hand and on captures of real games."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.analysis.metrics import stability
from lodbench.analysis.metrics.budget import longest_stretch_ms
from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric_registry import find_metric
from lodbench.analysis.metrics.over_frames import fps_low_mean, fps_low_percentile
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]


def displays(frame_ms: list[float]) -> np.ndarray:
    """Return display times whose intervals are these, the first frame at 5 ms."""
    return 5.0 + np.concatenate(((0.0,), np.cumsum(frame_ms)))


def value(metric_id: str, log: FrameLog, warmup_s: float = 0.0) -> float | None:
    """Return a metric of a log."""
    return find_metric(metric_id)(MeasuredFrames(log, warmup_s))


def test_interval_statistics_by_hand(make_log: MakeLog) -> None:
    """Intervals 10, 20, 30, 40 ms have these mean, deviation (N - 1), quantiles and maximum."""
    log = make_log(displays([10, 20, 30, 40]))
    expected = {"mean": 25.0, "sd": 12.909944487358056, "p50": 25.0, "p95": 38.5, "max": 40.0}
    for suffix, truth in expected.items():
        assert value(f"frame_ms_{suffix}", log) == pytest.approx(truth), suffix


def test_work_is_the_larger_of_cpu_and_gpu(make_log: MakeLog) -> None:
    """work_ms takes the larger time of each frame and is not quantised by the display."""
    log = make_log([16.0, 32.0, 48.0], cpu_ms=[3.0, 8.0, 2.0], gpu_ms=[5.0, 4.0, 9.0])
    assert value("work_ms_mean", log) == pytest.approx((5 + 8 + 9) / 3)
    assert value("work_ms_max", log) == 9.0


def test_dropped_frames_have_no_interval(make_log: MakeLog) -> None:
    """A frame that mailbox replaced is skipped: the interval spans it."""
    log = make_log([10.0, np.nan, 30.0, 40.0], mode="mailbox")
    assert np.isnan(MeasuredFrames(log).frame_ms).tolist() == [True, True, False, False]
    assert value("frame_ms_max", log) == pytest.approx(20.0)


def test_warmup_is_cut_after_differences_are_taken(make_log: MakeLog) -> None:
    """The first measured frame keeps its interval to the last frame of the warm-up."""
    log = make_log(displays([100, 10, 20]))
    assert value("frame_ms_mean", log, warmup_s=0.02) == pytest.approx(15.0)


def test_three_low_definitions_by_hand(make_log: MakeLog) -> None:
    """99 frames of 10 ms and two of 100 ms: the definitions differ as their texts say."""
    log = make_log(displays([10.0] * 98 + [100.0, 100.0]))
    # 100 intervals: the 99th percentile lies at rank 98.01, between two values of 100 ms.
    assert value("fps_low1_percentile", log) == pytest.approx(10.0)
    assert value("fps_low1_mean", log) == pytest.approx(10.0)
    log = make_log(displays([10.0] * 99 + [109.0]))
    # Rank 98.01 is 1 % of the way from 10 to 109 ms; one frame is at least that long; it alone
    # fills 1 % of 1,099 ms.
    assert value("fps_low1_percentile", log) == pytest.approx(1000 / 10.99)
    assert value("fps_low1_mean", log) == pytest.approx(1000 / 109)
    assert value("fps_low1_integral", log) == pytest.approx(1000 / 109)


def test_hitches_follow_unreals_rule(make_log: MakeLog) -> None:
    """60 ms, 1.5 times the frame before, and 200 ms after the last hitch: two of these four."""
    frame_ms = [
        20.0,
        60.0,  # hitch
        20.0,
        65.0,  # 85 ms after the last one: dead time
        *[20.0] * 10,
        59.0,  # too short
        *[20.0] * 3,
        70.0,  # hitch
        71.0,  # not 1.5 times the frame before
    ]
    log = make_log(displays(frame_ms))
    flags = stability.hitch_flags(MeasuredFrames(log))
    assert np.flatnonzero(flags).tolist() == [2, 19]
    assert value("hitches_per_min", log) == pytest.approx(2 * 60_000 / sum(frame_ms))


@pytest.mark.parametrize(
    ("frame_ms", "hitches"),
    [
        ([20.0, 60.0, *[20.0] * 5, 100.0], [2, 8]),  # shown 200 ms after the last one
        ([20.0, 60.0, *[20.0] * 5, 99.0], [2]),  # 199 ms after it
        ([20.0, 60.0, *[20.0] * 4, 110.0, 20.0, 40.0, 60.0], [2, 10]),  # 190 ms, then 310 ms
        ([40.0, 60.0], [2]),  # 1.5 times the frame before
        ([41.0, 60.0], []),
    ],
)
def test_hitches_at_the_edges_of_the_rule(
    make_log: MakeLog, frame_ms: list[float], hitches: list[int]
) -> None:
    """What is just long, steep or late enough counts; dead time runs from the last that counted."""
    flags = stability.hitch_flags(MeasuredFrames(make_log(displays(frame_ms))))
    assert np.flatnonzero(flags).tolist() == hitches


def test_stutter_follows_capframex_rule(make_log: MakeLog) -> None:
    """A frame of 50 ms among 10 ms counts its time once: its own spike does not raise the mean."""
    frame_ms = [10.0] * 50 + [50.0] + [10.0] * 49
    assert value("stutter_time_fraction", make_log(displays(frame_ms))) == pytest.approx(50 / 1040)
    smooth = [10.0] * 50 + [24.0] + [10.0] * 49
    assert value("stutter_time_fraction", make_log(displays(smooth))) == 0.0


def test_what_is_just_short_enough_does_not_stutter(make_log: MakeLog) -> None:
    """Nine frames of 10 ms and one of 30: 3 times the one before, and 2.5 times the mean of 12."""
    assert value("stutter_time_fraction", make_log(displays([10.0] * 9 + [30.0]))) == 0.0
    # A little more is a spike, which counts as 10 ms and leaves the mean there.
    over = make_log(displays([10.0] * 9 + [30.001]))
    assert value("stutter_time_fraction", over) == pytest.approx(30.001 / 120.001)


def moving_average_by_loop(x: list[float]) -> list[float]:
    """CapFrameX's rule as a loop over samples."""
    window = max(round(10 * float(np.sqrt(np.mean(x)))), 1)
    means: list[float] = []
    for i in range(len(x)):
        chosen = range(max(0, i - window + 1), i + 1)
        tamed = [x[j - 1] if j > 0 and x[j] > 3 * x[j - 1] else x[j] for j in chosen]
        means.append(sum(tamed) / len(tamed))
    return means


@given(st.lists(st.floats(1.0, 200.0), min_size=1, max_size=60))
def test_moving_average_equals_the_loop(x: list[float]) -> None:
    """The vectorised moving average is the loop's, whatever the frame times."""
    average = stability.moving_average_ms(np.array(x))
    assert average == pytest.approx(moving_average_by_loop(x), rel=1e-9)


def test_budget_metrics_by_hand(make_log: MakeLog) -> None:
    """Work of 5, 11, 12, 9, 30 ms at 10 ms, in frames of 10, 20, 20, 10 and 40 ms.

    80 of 100 ms are over, 40 of them in a row twice, and three times the budget at most.
    """
    log = make_log([10.0, 30.0, 50.0, 60.0, 100.0], cpu_ms=[5.0, 11.0, 12.0, 9.0, 30.0])
    assert value("over_budget_time_fraction", log) == pytest.approx(0.8)
    assert value("longest_over_budget_ms", log) == pytest.approx(40.0)
    assert value("over_budget_max_ratio", log) == pytest.approx(3.0)
    assert value("utilisation", log) == pytest.approx((50 + 220 + 240 + 90 + 1200) / 1000)


def test_work_that_just_fits_is_within_the_budget(make_log: MakeLog) -> None:
    """Of 11, 10, 12 and 10 ms at 10 ms two are over, and no two of them in a row."""
    log = make_log(cpu_ms=[11.0, 10.0, 12.0, 10.0], gpu_ms=np.ones(4))
    assert value("over_budget_time_fraction", log) == 0.5
    assert value("longest_over_budget_ms", log) == pytest.approx(10.0)


@given(st.lists(st.booleans(), min_size=1, max_size=40))
def test_longest_stretch_equals_the_string_split(flags: list[bool]) -> None:
    """In frames of 1 ms, it is the longest part of the string split at the unset flags."""
    text = "".join("x" if flag else "." for flag in flags)
    longest = max(len(part) for part in text.split("."))
    assert longest_stretch_ms(np.array(flags), np.ones(len(flags))) == pytest.approx(longest)


def test_missed_vsync_counts_refreshes_without_a_new_frame(make_log: MakeLog) -> None:
    """At 60 Hz, intervals of 1, 1, 2 and 3 refreshes miss 3 of 7; immediate mode has no refresh."""
    period = 1000 / 60
    shown = displays([period, period, 2 * period, 3 * period])
    assert value("missed_vsync_fraction", make_log(shown, mode="vsync")) == pytest.approx(3 / 7)
    assert value("missed_vsync_fraction", make_log(shown)) is None


def test_frame_delta_is_between_successive_intervals(make_log: MakeLog) -> None:
    """Intervals 10, 14, 13 differ by 4 and 1: the 95th percentile lies 95 % of the way up."""
    log = make_log(displays([10.0, 14.0, 13.0]))
    assert value("frame_delta_ms_p95", log) == pytest.approx(1 + 0.95 * 3)


@given(st.lists(st.floats(1.0, 100.0), min_size=2, max_size=50))
@settings(deadline=None)
def test_lows_are_ordered(frame_ms: list[float]) -> None:
    """The mean of the slowest frames is never above their quantile's frame rate."""
    x = np.array(frame_ms)
    low = fps_low_percentile(x, 0.01)
    mean = fps_low_mean(x, 0.01)
    assert low is not None
    assert mean is not None
    assert mean <= low * (1 + 1e-12)
    assert 1000 / x.max() <= mean * (1 + 1e-12)


REAL_LOWS = {
    # file, column: percentile, mean, integral; as PresentMon, CapFrameX and RTSS define them
    ("presentmon-v1-farcrynewdawn.csv", "MsBetweenPresents"): (59.4, 29.5, 12.5),
    ("ocat-metroexodus.csv", "MsBetweenPresents"): (79.0, 73.7, 78.1),
    ("threejs-pirateconquest-large_battle.csv", "dt"): (41.8, 39.5, 40.5),
}


@pytest.mark.realdata
@pytest.mark.parametrize(("source", "lows"), REAL_LOWS.items(), ids=lambda item: str(item[0]))
def test_lows_of_real_captures(
    source: tuple[str, str], lows: tuple[float, float, float], data_dir: Path, make_log: MakeLog
) -> None:
    """On real captures the three 1 % lows are those that the tools print, up to 4.7 times apart."""
    name, column = source
    with (data_dir / "logs" / name).open(newline="") as file:
        frame_ms = [float(row[column]) for row in csv.DictReader(file)]
    log = make_log(displays(frame_ms))
    for kind, truth in zip(("percentile", "mean", "integral"), lows, strict=True):
        assert value(f"fps_low1_{kind}", log) == pytest.approx(truth, abs=0.05), kind
