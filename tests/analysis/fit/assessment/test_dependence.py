"""What frames are worth, and what the order of residuals is in a profile."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.fit.assessment.dependence import frame_worth
from lodbench.analysis.fit.estimate import posterior_of
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.noise import residual_model
from lodbench.analysis.fit.terms import parse_terms

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")


def worth_of(sample: Sample, model: str = "gaussian") -> float:
    """Return the worth of a frame."""
    return posterior_of(sample, TERMS, "student-t" if model == "student-t" else "gaussian")[1].worth


@pytest.mark.parametrize("model", ["gaussian", "student-t"])
def test_independent_frames_count_in_full(make_sample: MakeSample, model: str):
    """Over ten logs, frames of a true model are worth nearly one each, and never more."""
    worth = [worth_of(make_sample(seed=seed), model) for seed in range(10)]
    assert max(worth) <= 1.0
    assert np.mean(worth) > 0.95


def test_frames_that_err_alike_count_for_less(make_sample: MakeSample):
    """With slow predictors and an autoregression of 0.8, of autocorrelation time 9, for a ninth."""
    sample = make_sample("correlated", frames=4_000)
    turn = np.linspace(0.0, 40.0 * np.pi, 4_000)
    slow = np.column_stack([200 + 150 * np.sin(turn), 1e6 + 8e5 * np.cos(turn)])
    noise = sample.time_ms - 4.0 - sample.predictors @ np.array([0.02, 5e-6])
    sample = Sample(sample.names, slow, 4.0 + slow @ np.array([0.02, 5e-6]) + noise, sample.series)
    assert worth_of(sample) == pytest.approx(1.0 / 9.0, rel=0.25)


def test_predictors_that_change_at_random_lose_less(make_sample: MakeSample):
    """Where views are independent only the base suffers from correlated noise."""
    worth = worth_of(make_sample("correlated", frames=4_000))
    assert worth == pytest.approx(1.0 / ((9.0 + 1.0 + 1.0) / 3.0), rel=0.3)


def test_noise_that_is_no_students_t_counts_for_less(make_sample: MakeSample):
    """A clean core with one outlier in twenty is not of one t, and the likelihood too sure."""
    sample = make_sample("outliers", frames=2_000)
    worth = worth_of(sample, "student-t")
    assert 0.5 < worth < 0.95


def test_the_worth_does_not_depend_on_units(make_sample: MakeSample):
    """Thousands of triangles, or nanoseconds, are the same log."""
    sample = make_sample("correlated")
    design, posterior, center = posterior_of(sample, TERMS, "gaussian")
    bigger = Sample(sample.names, sample.predictors * [1.0, 1e3], sample.time_ms, sample.series)
    assert worth_of(bigger) == pytest.approx(posterior.worth, rel=1e-3)
    again = frame_worth(sample, design, center, posterior.likelihood)
    assert again == pytest.approx(posterior.worth, rel=0.05)


def test_logs_are_not_joined_end_to_end(make_sample: MakeSample):
    """Two constant offsets in two logs are no correlation of white noise within each."""
    one, two = make_sample(seed=1, frames=500), make_sample(seed=2, frames=500)
    both = Sample(
        one.names,
        np.vstack([one.predictors, two.predictors]),
        np.concatenate([one.time_ms + 1.0, two.time_ms - 1.0]),
        np.repeat([0, 1], 500),
    )
    joined = Sample(both.names, both.predictors, both.time_ms, np.zeros(1_000, dtype=np.int64))
    assert worth_of(both) > 2.0 * worth_of(joined)


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
