"""Blocks of frames, and intervals compared with known sampling distributions."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric import Metric
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.sample import Sample
from lodbench.analysis.metrics.statistic import (
    fps_low_integral,
    fps_low_mean,
    maximum,
    mean,
    quantile,
    sd,
)
from lodbench.analysis.verdict.bootstrap import BLOCKS, Blocks, draw_blocks
from lodbench.sim.frame_log import FrameLog

MakeLog = Callable[..., FrameLog]


def blocks(resamples: int, seed: int = 0) -> Blocks:
    """Return blocks from a seed."""
    return draw_blocks(np.random.SeedSequence(seed), resamples)


def frames_of(sample: Sample) -> list[list[int]]:
    """Return the frames of each sample, one by one."""
    return [
        [at % sample.frames for pair in zip(first, past, strict=True) for at in range(*pair)]
        for first, past in zip(sample.first.tolist(), sample.past.tolist(), strict=True)
    ]


def sample_of(drawn: Blocks, time_ns: np.ndarray) -> Sample:
    """Return all resamples of a short run at once."""
    (sample,) = drawn.samples(time_ns)
    return sample


def test_stretches_by_hand() -> None:
    """Two blocks of half a run of 4 frames: from a quarter on, and from the last frame round."""
    time_ns = np.array([0, 10, 20, 30], dtype=np.int64)
    sample = sample_of(Blocks(np.array([[0.25, 0.75]])), time_ns)
    assert (sample.first.tolist(), sample.past.tolist()) == ([[1, 3]], [[3, 5]])
    assert sample.counts().tolist() == [[1, 1, 1, 1]]
    assert frames_of(sample) == [[1, 2, 3, 0]]


def test_uneven_frames_are_taken_by_time() -> None:
    """A block of half the time holds many short frames or a few long ones."""
    time_ns = np.array([0, 1, 2, 3, 4, 5, 10], dtype=np.int64)
    sample = sample_of(Blocks(np.array([[0.0, 0.0], [0.5, 0.5]])), time_ns)
    period = 10 * 7 / 6
    assert sample.counts().tolist() == [[2, 2, 2, 2, 2, 2, 0], [0, 0, 0, 0, 0, 0, 2]]
    assert 5 < period / 2 < 10


@given(st.lists(st.integers(1, 10**9), min_size=1, max_size=80), st.integers(0, 2**32))
def test_every_frame_is_drawn_equally_often(steps: list[int], seed: int) -> None:
    """Over starts spread evenly on the circle each frame is in as many blocks as any other."""
    time_ns = np.cumsum(np.array(steps, dtype=np.int64))
    start = (np.arange(6000) + (seed % 997) / 997) / 6000
    sample = sample_of(Blocks(np.repeat(start[:, np.newaxis], 10, axis=1)), time_ns)
    count = sample.counts().sum(axis=0)
    assert count.min() >= 10 * 599
    assert count.max() <= 10 * 601


def test_interval_of_independent_frames_is_the_textbook_one() -> None:
    """For independent values the spread of the resampled mean is the standard error."""
    x = np.random.default_rng(1).normal(10.0, 2.0, 3000)
    time_ns = np.arange(3000, dtype=np.int64) * 16_666_667
    resampled = np.concatenate([mean(x).of(part) for part in blocks(800).samples(time_ns)])
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
    resampled = np.concatenate([mean(x).of(part) for part in blocks(400).samples(time_ns)])
    truth = (1.0 / 0.1) / np.sqrt(n)  # sd of the mean of an AR(1): sigma / (1 - phi) / sqrt(n)
    assert resampled.std() == pytest.approx(truth, rel=0.35)


def test_resamples_in_chunks_equal_resamples_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Long runs are reduced in parts, with the same result."""
    x = np.random.default_rng(3).random(500)
    time_ns = np.arange(500, dtype=np.int64)
    whole = quantile(x, 0.9).of(sample_of(blocks(40), time_ns))
    monkeypatch.setattr("lodbench.analysis.verdict.bootstrap._LARGEST_MATRIX", 1000)
    parts = list(blocks(40).samples(time_ns))
    assert len(parts) == 20
    assert np.concatenate([quantile(x, 0.9).of(part) for part in parts]).tolist() == whole.tolist()


@given(st.integers(0, 2**32))
def test_statistics_are_those_of_the_frames_written_out(seed: int) -> None:
    """Sums by stretches and quantiles by counts are what numpy says of each resample's frames."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 60))
    x = rng.choice([1.0, 2.5, 4.0, 5.0, np.nan], n) * rng.choice([1.0, 1.1], n)
    sample = sample_of(blocks(6, seed), np.cumsum(rng.integers(1, 50, n)))
    for at, frames in enumerate(frames_of(sample)):
        known = x[frames][~np.isnan(x[frames])]
        expected: dict[str, float] = dict.fromkeys(
            ("mean", "sd", "p90", "max", "low", "part"), np.nan
        )
        if len(known):
            expected |= {"mean": known.mean(), "max": known.max(), "p90": np.quantile(known, 0.9)}
            # A share of which no rank is whole: there `>=` hangs on a rounding.
            least = np.quantile(known, 1.0 - 0.23, method="median_unbiased")
            expected["low"] = 1e3 / known[known >= least].mean()
            slowest = np.sort(known)[::-1]
            reached = np.cumsum(slowest)
            expected["part"] = 1e3 / slowest[np.argmax(reached >= 0.2371 * reached[-1])]
        if len(known) > 1:
            expected["sd"] = known.std(ddof=1)
        got = {
            "mean": mean(x).of(sample)[at],
            "sd": sd(x).of(sample)[at] if (~np.isnan(x)).any() else np.nan,
            "p90": quantile(x, 0.9).of(sample)[at],
            "max": maximum(x).of(sample)[at],
            "low": fps_low_mean(x, 0.23).of(sample)[at],
            "part": fps_low_integral(x, 0.2371).of(sample)[at],
        }
        # A deviation of 0 is off by the root of a rounding.
        assert got == pytest.approx(expected, rel=1e-9, abs=1e-6, nan_ok=True)


def test_same_seed_same_blocks() -> None:
    """Blocks depend on the seed alone and have the stated shape."""
    assert blocks(5, seed=7).start.tolist() == blocks(5, seed=7).start.tolist()
    assert blocks(5, seed=7).start.tolist() != blocks(5, seed=8).start.tolist()
    assert blocks(5).start.shape == (5, BLOCKS)


@pytest.mark.parametrize("metric", METRICS, ids=lambda metric: metric.id)
def test_identity_resample_gives_the_value(metric: Metric, make_log: MakeLog) -> None:
    """Two stretches that make every frame once return the metric itself."""
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
    sample = Sample(n, np.array([[100, 250]]), np.array([[250, 400]]))
    assert statistic.of(sample)[0] == pytest.approx(statistic.value(), rel=1e-12)
