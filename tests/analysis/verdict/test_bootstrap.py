"""Blocks of frames, and intervals compared with known sampling distributions."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric import Metric
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.statistic import mean, quantile
from lodbench.analysis.verdict.bootstrap import BLOCKS, Blocks, draw_blocks
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]


def blocks(resamples: int, seed: int = 0) -> Blocks:
    """Return blocks from a seed."""
    return draw_blocks(np.random.SeedSequence(seed), resamples)


def test_rows_by_hand() -> None:
    """Two blocks of half a run of 4 frames: from a quarter on, and from the last frame round."""
    rows = Blocks(np.array([[0.25, 0.75]])).rows(np.array([0, 10, 20, 30], dtype=np.int64))
    assert rows.tolist() == [[1, 2, 3, 0]]


def test_uneven_frames_are_taken_by_time() -> None:
    """A block of half the time holds many short frames or a few long ones; rows are padded."""
    time_ns = np.array([0, 1, 2, 3, 4, 5, 10], dtype=np.int64)
    rows = Blocks(np.array([[0.0, 0.0], [0.5, 0.5]])).rows(time_ns)
    period = 10 * 7 / 6
    assert rows[0].tolist() == [0, 1, 2, 3, 4, 5] * 2
    assert [frame for frame in rows[1].tolist() if frame < 7] == [6, 6]
    assert rows[1].tolist().count(7) == 10
    assert 5 < period / 2 < 10


@given(st.lists(st.integers(1, 10**9), min_size=1, max_size=80), st.integers(0, 2**32))
def test_every_frame_is_drawn_equally_often(steps: list[int], seed: int) -> None:
    """Over starts spread evenly on the circle each frame is in as many blocks as any other."""
    time_ns = np.cumsum(np.array(steps, dtype=np.int64))
    n = len(time_ns)
    start = (np.arange(6000) + (seed % 997) / 997) / 6000
    rows = Blocks(np.repeat(start[:, np.newaxis], 10, axis=1)).rows(time_ns)
    count = np.bincount(rows[rows < n], minlength=n)
    assert count.min() >= 10 * 599
    assert count.max() <= 10 * 601


def test_interval_of_independent_frames_is_the_textbook_one() -> None:
    """For independent values the spread of the resampled mean is the standard error."""
    x = np.random.default_rng(1).normal(10.0, 2.0, 3000)
    time_ns = np.arange(3000, dtype=np.int64) * 16_666_667
    resampled = mean(x).resampled(blocks(800).rows(time_ns))
    assert resampled.std() == pytest.approx(2.0 / np.sqrt(3000), rel=0.35)
    assert resampled.mean() == pytest.approx(x.mean(), abs=0.01)


def test_interval_of_dependent_frames_is_wider() -> None:
    """For an autoregression of 0.9 the mean's error is sqrt(19) times the independent one."""
    rng = np.random.default_rng(2)
    n = 20_000
    x = np.zeros(n)
    noise = rng.normal(0.0, 1.0, n)
    for i in range(1, n):
        x[i] = 0.9 * x[i - 1] + noise[i]
    time_ns = np.arange(n, dtype=np.int64) * 1_000_000
    resampled = mean(x).resampled(blocks(400).rows(time_ns))
    truth = (1.0 / 0.1) / np.sqrt(n)  # sd of the mean of an AR(1): sigma / (1 - phi) / sqrt(n)
    assert resampled.std() == pytest.approx(truth, rel=0.35)


def test_resamples_in_chunks_equal_resamples_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Long runs are reduced in parts, with the same result."""
    x = np.random.default_rng(3).random(500)
    rows = blocks(40).rows(np.arange(500, dtype=np.int64))
    whole = quantile(x, 0.9).resampled(rows)
    monkeypatch.setattr("lodbench.analysis.metrics.statistic._LARGEST_MATRIX", 1000)
    assert quantile(x, 0.9).resampled(rows).tolist() == whole.tolist()


def test_same_seed_same_blocks() -> None:
    """Blocks depend on the seed alone and have the stated shape."""
    assert blocks(5, seed=7).start.tolist() == blocks(5, seed=7).start.tolist()
    assert blocks(5, seed=7).start.tolist() != blocks(5, seed=8).start.tolist()
    assert blocks(5).start.shape == (5, BLOCKS)


@pytest.mark.parametrize("metric", METRICS, ids=lambda metric: metric.id)
def test_identity_resample_gives_the_value(metric: Metric, make_log: MakeLog) -> None:
    """Taking every frame once, and padding, returns the metric itself."""
    rng = np.random.default_rng(4)
    n = 300
    work = rng.gamma(20.0, 0.5, n)
    shown = np.cumsum(work) + 5.0
    shown[40] = np.nan
    log = make_log(
        shown,
        mode="vsync",
        cpu_ms=work / 2,
        gpu_ms=work,
        predicted_gpu_ms=work * rng.normal(1.0, 0.1, n),
        full_gpu_ms=np.repeat([5.0, 30.0, 6.0], 100),
        benefit=rng.random(n),
        full_benefit=1.0,
        benefit_bound=1.0,
        degradation=1 + rng.random(n),
        full_degradation=1.0,
        drawn=5,
        sse_px_p95=rng.random(n),
        toggles=rng.poisson(2.0, n),
        levels_extracted=rng.poisson(1.0, n),
    )
    statistic = metric(MeasuredFrames(log))
    assert statistic is not None
    rows = np.append(np.arange(n), (n, n))[np.newaxis].astype(np.int32)
    assert statistic.resampled(rows)[0] == pytest.approx(statistic.value(), rel=1e-12)
