"""What frames are worth, and what the order of residuals is in a profile."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.fit.assessment.slow_error import slow_error
from lodbench.analysis.fit.assessment.spikes import are_spikes
from lodbench.analysis.fit.estimate import posterior_of
from lodbench.analysis.fit.fit_frames import Origin, Sample
from lodbench.analysis.fit.noise import residual_model
from lodbench.analysis.fit.terms import parse_terms

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")


def worth_of(sample: Sample, model: str = "gaussian") -> np.ndarray:
    """Return the worth of a frame along each direction, that of a common factor first."""
    posterior = posterior_of(sample, TERMS, "student-t" if model == "student-t" else "gaussian")[1]
    assert posterior.stretch is not None
    return 1.0 / posterior.stretch.found.times


@pytest.mark.parametrize("model", ["gaussian", "student-t"])
def test_independent_frames_count_in_full(make_sample: MakeSample, model: str):
    """Four in five at least, over ten logs of 150 frames, whose order tells little; never more."""
    worth = np.array([worth_of(make_sample(seed=seed), model) for seed in range(10)])
    assert worth.max() <= 1.0
    assert worth.mean() > 0.8


def test_frames_that_err_alike_count_for_less(make_sample: MakeSample):
    """With slow predictors and an autoregression of 0.8, of autocorrelation time 9, for a ninth."""
    sample = make_sample("correlated", frames=4_000)
    turn = np.linspace(0.0, 40.0 * np.pi, 4_000)
    slow = np.column_stack([200 + 150 * np.sin(turn), 1e6 + 8e5 * np.cos(turn)])
    noise = sample.time_ms - 4.0 - sample.predictors @ np.array([0.02, 5e-6])
    sample = Sample(sample.names, slow, 4.0 + slow @ np.array([0.02, 5e-6]) + noise, sample.series)
    assert worth_of(sample) == pytest.approx(np.full(3, 1.0 / 9.0), rel=0.35)


def test_predictors_that_change_at_random_lose_less(make_sample: MakeSample):
    """Where views are independent only a common factor suffers from correlated noise."""
    worth = worth_of(make_sample("correlated", frames=4_000))
    assert worth == pytest.approx(np.array([1.0 / 9.0, 1.0, 1.0]), rel=0.3)


def test_noise_that_is_no_students_t_counts_for_less(make_sample: MakeSample):
    """A clean core with one outlier in twenty is not of one t, and the likelihood too sure."""
    sample = make_sample("outliers", frames=2_000)
    worth = worth_of(sample, "student-t")
    assert 0.5 < worth[1:].mean() < 0.95


def test_the_worth_does_not_depend_on_units(make_sample: MakeSample):
    """Thousands of triangles, or nanoseconds, are the same log."""
    sample = make_sample("correlated")
    bigger = Sample(sample.names, sample.predictors * [1.0, 1e3], sample.time_ms, sample.series)
    assert worth_of(bigger) == pytest.approx(worth_of(sample), rel=0.02)


def test_logs_are_not_joined_end_to_end(make_sample: MakeSample):
    """Two constant offsets in two logs are no correlation of white noise within each."""
    one, two = make_sample(seed=1, frames=500), make_sample(seed=2, frames=500)
    both = Sample(
        one.names,
        np.vstack([one.predictors, two.predictors]),
        np.concatenate([one.time_ms + 1.0, two.time_ms - 1.0]),
        np.repeat([0, 1], 500),
        (Origin("", "one"), Origin("", "one")),
    )
    joined = Sample(both.names, both.predictors, both.time_ms, np.zeros(1_000, dtype=np.int64))
    assert worth_of(both)[0] > 2.0 * worth_of(joined)[0]


def test_the_residual_model_recovers_what_made_the_residuals():
    """An autoregression with known correlation, tails and scale is found again."""
    rng = np.random.default_rng(6)
    fresh = rng.standard_t(4, 20_000) * 0.05 * np.sqrt(1.0 - 0.8**2)
    series = np.zeros(20_000)
    for k in range(1, len(series)):
        series[k] = 0.8 * series[k - 1] + fresh[k]
    model = residual_model([series[:10_000], series[10_000:]])
    assert model.kind == "student-t"
    assert model.correlation == pytest.approx(0.8, abs=0.02)
    assert model.scale == pytest.approx(0.05, rel=0.05)
    assert model.dof == pytest.approx(4.0, rel=0.15)


def test_the_residual_model_of_gaussian_noise():
    """White noise of 3 % has that scale, no correlation, and a floor under its lowest factor."""
    noise = 0.03 * np.random.default_rng(2).standard_normal(5_000)
    model = residual_model([noise], "gaussian")
    assert model.kind == "gaussian"
    assert model.scale == pytest.approx(0.03, rel=0.05)
    assert model.correlation < 0.03
    assert model.floor == 0.8


def walk(rng: np.random.Generator, count: int, frames: float) -> np.ndarray:
    """Return an autoregression of variance 1 that forgets in so many frames."""
    keeps, values = np.exp(-1.0 / frames), rng.standard_normal(count)
    for k in range(1, count):
        values[k] = keeps * values[k - 1] + np.sqrt(1.0 - keeps**2) * values[k]
    return values


def test_a_mean_of_slow_errors_is_known_as_well_as_stretches_were_seen():
    """White errors as one each; of slow ones 1,200 frames are few, and the t's tails heavier."""
    rng = np.random.default_rng(8)
    white = [slow_error(rng.standard_normal(1_200)) for _ in range(20)]
    slow = [slow_error(walk(rng, 1_200, 100.0)) for _ in range(20)]
    assert np.median([error.times for error in white]) == pytest.approx(1.0, abs=0.1)
    assert np.median([error.dof for error in white]) > 30.0
    assert 60.0 < np.median([error.times for error in slow]) < 500.0
    assert np.median([error.dof for error in slow]) < 20.0


def test_spikes_stand_out_from_their_neighbours_and_episodes_do_not():
    """Ten lone frames of twice the time are spikes; a slow minute and its ends are none."""
    rng = np.random.default_rng(3)
    residual = 0.02 * rng.standard_normal(600)
    residual[200:300] += 0.3
    lone = np.arange(25, 525, 50)
    residual[lone] += 1.0
    assert np.flatnonzero(are_spikes(residual)).tolist() == lone.tolist()


def test_the_residual_model_tells_a_slow_state_from_fast_noise():
    """7 % that forgets in 4 s beside an autoregression of 5 %, at 30 frames a second."""
    rng = np.random.default_rng(11)
    fast = 0.05 * walk(rng, 30_000, -1.0 / np.log(0.6))
    slow = 0.07 * walk(rng, 30_000, 120.0)
    model = residual_model([(1.0 + fast) * (1.0 + slow) - 1.0], "student-t", 1.0 / 30.0)
    assert model.slow_scale == pytest.approx(0.07, rel=0.2)
    assert model.slow_time_s == pytest.approx(4.0, rel=0.4)
    assert model.correlation == pytest.approx(0.6, abs=0.1)
    assert model.scale == pytest.approx(0.05, rel=0.15)
    assert model.spike_share == 0.0


def test_the_residual_model_counts_spikes():
    """One frame in fifty, 60 % longer on average: share and size, and a core without them."""
    rng = np.random.default_rng(12)
    hit = rng.random(20_000) < 0.02
    noise = 0.03 * rng.standard_normal(20_000)
    model = residual_model([(1.0 + noise) * (1.0 + hit * rng.exponential(0.6, 20_000)) - 1.0])
    assert model.spike_share == pytest.approx(0.02, rel=0.2)
    assert model.spike_scale == pytest.approx(0.6, rel=0.2)
    assert model.scale == pytest.approx(0.03, rel=0.1)
    assert model.dof > 10.0


def test_what_frames_of_one_view_have_in_common_is_correlation_along_the_path():
    """Drawn twice in shuffled order, white in that order; along the path neighbours err alike."""
    rng = np.random.default_rng(13)
    missed = 0.05 * walk(rng, 2_000, 20.0)
    path = np.concatenate([rng.permutation(2_000), rng.permutation(2_000)])
    residual = missed[path] + 0.02 * rng.standard_normal(4_000)
    alone = residual_model([residual], "student-t")
    along = residual_model([residual], "student-t", paths=[path])
    assert alone.correlation < 0.1
    assert along.correlation == pytest.approx(0.95 * 0.05**2 / (0.05**2 + 0.02**2), abs=0.06)
    assert along.slow_scale == 0.0
