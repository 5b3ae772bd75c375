"""Timers that are read back late: found by the frames they are late, and shifted back."""

from time import perf_counter

import numpy as np
import pytest

from lodbench.traces.logs.checks.late import frames_late, shifted
from lodbench.traces.logs.log_checks import check_log
from lodbench.traces.logs.render_log import RenderLog


def log_of(lag: int, noise: float = 0.1, frames: int = 400, still: bool = False) -> RenderLog:
    """Make a log whose GPU time is of some frames before."""
    rng = np.random.default_rng(2)
    counts = rng.uniform(0.5e6, 3e6, (frames, 2))
    if still:  # neighbours alike, as along a slow walk
        counts = np.cumsum(rng.normal(0.0, 2e4, (frames, 2)), axis=0) + 2e6
    gpu_ms = 1.0 + 2e-6 * counts[:, 0] + 1e-6 * counts[:, 1] + rng.normal(0.0, noise, frames)
    late = np.concatenate((np.zeros(lag), gpu_ms[: frames - lag]))
    return RenderLog("late", "csv", ("triangles", "vertices"), counts, gpu_ms=late)


@pytest.mark.parametrize("lag", range(5))
def test_the_lag_is_found_and_undone(lag: int):
    """Up to four frames; the shifted log has no lag and the last frames no time."""
    log = log_of(lag)
    assert frames_late(log, "gpu_ms")[0] == lag
    back = shifted(log, "gpu_ms", lag)
    assert frames_late(back, "gpu_ms")[0] == 0
    assert np.isnan(back.time("gpu_ms")).sum() == lag
    found = [finding.kind for finding in check_log(log)]
    assert found == (["late"] if lag else [])


def test_noise_and_slow_walks_show_no_lag():
    """Where counts explain nothing, or neighbours are alike, nothing is shifted."""
    assert frames_late(log_of(0, noise=50.0), "gpu_ms")[0] == 0
    assert frames_late(log_of(0, still=True), "gpu_ms")[0] == 0


def test_a_log_of_2000_rows_is_checked_within_300_ms():
    """All checks together, with three times and a clock."""
    rng = np.random.default_rng(3)
    log = log_of(2, frames=2_000)
    full = RenderLog(
        "full",
        "csv",
        log.predictors,
        log.counts,
        frame_ms=rng.uniform(10.0, 20.0, 2_000),
        gpu_ms=log.gpu_ms,
        cpu_ms=rng.uniform(3.0, 9.0, 2_000),
        time_s=np.arange(2_000) / 60.0,
    )
    best = min(timed(full) for _ in range(3))
    assert best < 0.3


def timed(log: RenderLog) -> float:
    """Return the seconds that the checks of a log take."""
    start = perf_counter()
    check_log(log)
    return perf_counter() - start
