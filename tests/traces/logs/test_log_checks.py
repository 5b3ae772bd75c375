"""Traps of real logs: each is found where it is, and not where it is not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.traces.logs.log_checks import capped_at_hz, check_log
from lodbench.traces.logs.render_log import FloatArray, RenderLog


def log_of(frame_ms: Sequence[float] | FloatArray, **columns: FloatArray) -> RenderLog:
    """Make a log whose triangles vary from frame to frame."""
    count = len(frame_ms)
    return RenderLog(
        name="log",
        format="csv",
        predictors=("triangles",),
        counts=columns.get("triangles", np.linspace(1e4, 1e6, count))[:, np.newaxis],
        frame_ms=np.array(frame_ms),
        gpu_ms=columns.get("gpu_ms"),
        time_s=columns.get("time_s"),
    )


def kinds(log: RenderLog) -> set[tuple[str, str]]:
    """Kind and column of what is found."""
    return {(finding.kind, finding.column) for finding in check_log(log)}


def free_running(seed: int = 0, count: int = 1_000) -> FloatArray:
    """Frame times of a renderer that nothing caps."""
    rng = np.random.default_rng(seed)
    load = 1.0 + 0.4 * np.sin(np.arange(count) / 40.0)
    return 14.0 * load * (1.0 + 0.05 * rng.standard_normal(count))


def test_times_at_multiples_of_the_refresh_are_capped():
    """Frames of one, two and three refreshes of 60 Hz carry no cost."""
    rng = np.random.default_rng(1)
    refreshes = rng.choice([1, 2, 3], 400, p=[0.7, 0.25, 0.05])
    frame_ms = refreshes * 1e3 / 60 + rng.normal(0.0, 0.1, 400)
    assert capped_at_hz(frame_ms) == 60.0
    findings = check_log(log_of(frame_ms, gpu_ms=free_running(2, 400)))
    assert [(f.kind, f.column, f.refuse) for f in findings] == [("capped", "frame_ms", True)]
    assert "60 Hz" in findings[0].message
    assert "fit gpu_ms" in findings[0].message


def test_a_jittering_clock_does_not_hide_the_refresh():
    """Moments of presenting at 59.97 Hz, read with 2 ms of jitter, are still locked to it."""
    rng = np.random.default_rng(3)
    moments = np.arange(3_001) * 1e3 / 59.97 + rng.normal(0.0, 2.0, 3_001)
    rate = capped_at_hz(np.diff(moments))
    assert rate == pytest.approx(59.97, abs=0.02)


@pytest.mark.parametrize("seed", range(5))
def test_a_free_running_renderer_is_not_capped(seed: int):
    """Even where its mean is a refresh, its presents drift through all phases."""
    frame_ms = free_running(seed)
    assert capped_at_hz(frame_ms) is None
    assert capped_at_hz(frame_ms * (1e3 / 60) / frame_ms.mean()) is None


def test_stale_gpu_times_are_found():
    """A time that repeats in every third frame is a read-back that came late."""
    gpu_ms = free_running(4, 300).round(4)
    gpu_ms[2::3] = gpu_ms[1::3]
    assert kinds(log_of(free_running(5, 300), gpu_ms=gpu_ms)) == {("stale", "gpu_ms")}


def test_coarse_times_repeat_by_chance_and_are_not_stale():
    """Times in whole milliseconds repeat about as often as their distribution says."""
    assert kinds(log_of(free_running(6, 300).round(0))) == set()


def test_a_timer_that_was_never_read_is_refused():
    """A column of zeros is no measurement of a fast GPU."""
    gpu_ms = np.zeros(300)
    assert kinds(log_of(free_running(7, 300), gpu_ms=gpu_ms)) == {("unmeasured", "gpu_ms")}


def test_a_software_rasteriser_has_no_gpu_time():
    """The renderer's name in the header says whose timer query it was."""
    log = log_of(free_running(8, 300), gpu_ms=free_running(9, 300))
    named = replace(log, header=(("renderer", "llvmpipe (LLVM 15.0.6, 256 bits)"),))
    assert kinds(log) == set()
    assert kinds(named) == {("software-timer", "gpu_ms")}


def test_sampled_logs_are_found_and_slow_clocks_are_not():
    """Frame times far below the elapsed time were sampled; far above, the clock is the trace's."""
    frame_ms = free_running(10, 300)
    assert kinds(log_of(frame_ms, time_s=np.linspace(0.0, 29.9, 300))) == {("sampled", "")}
    assert kinds(log_of(frame_ms, time_s=np.cumsum(frame_ms) / 1e3)) == set()
    assert kinds(log_of(frame_ms, time_s=np.arange(300) / 1e3)) == set()


def test_a_clock_that_runs_backwards_means_several_captures():
    """Two captures in one file restart the clock once."""
    frame_ms = free_running(11, 300)
    clock = np.cumsum(frame_ms) / 1e3
    clock[150:] -= clock[150]
    findings = check_log(log_of(frame_ms, time_s=clock))
    assert [finding.kind for finding in findings] == ["backwards"]
    assert "1 times" in findings[0].message


def test_a_view_that_stands_still_identifies_nothing():
    """Triangles within 1 % of their mean cannot be told from set-up."""
    triangles = 1e6 * (1.0 + 0.01 * np.sin(np.arange(300)))
    assert kinds(log_of(free_running(12, 300), triangles=triangles)) == {("still", "")}


@given(
    st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=1, max_size=300),
    st.floats(allow_nan=True, allow_infinity=True),
)
def test_checks_bear_any_numbers(frame_ms: list[float], clock: float):
    """NaN, infinities, negatives and huge values are judged without a warning."""
    log = log_of(frame_ms, time_s=np.full(len(frame_ms), clock), gpu_ms=np.array(frame_ms))
    assert all("\n" not in str(finding) for finding in check_log(log))
