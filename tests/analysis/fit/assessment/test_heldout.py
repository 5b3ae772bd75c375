"""Held-out errors: which frames are held out, and what is said of them."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats

from lodbench.analysis.fit.assessment.heldout import (
    HeldOut,
    block_numbers,
    folds_of,
    hold_out,
    judge,
    split_of,
)
from lodbench.analysis.fit.assessment.posterior_predictive import Draws, check_predictive
from lodbench.analysis.fit.design import design_of
from lodbench.analysis.fit.estimate import estimate
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.errors import InputError

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")
SHORT = SamplerOptions(max_steps=500)


def test_blocks_are_of_25_frames_and_of_one_log():
    """Two logs of 120 and 110 frames have five blocks each; a short log has quarters."""
    numbers = block_numbers(np.repeat([0, 1, 2], [120, 110, 8]))
    assert np.bincount(numbers).tolist() == [25, 25, 25, 25, 20, 25, 25, 25, 25, 10, 2, 2, 2, 2]


def test_each_split_fits_about_half(make_sample: MakeSample):
    """Every second frame, or the first half of each log."""
    frames = make_sample(frames=100)
    two = Sample(frames.names, frames.predictors, frames.time_ms, np.repeat([0, 1], 50))
    assert np.flatnonzero(split_of(two, "interleaved")).tolist() == list(range(0, 100, 2))
    assert np.flatnonzero(split_of(two, "halves")).tolist() == [*range(25), *range(50, 75)]


def test_each_frame_is_held_out_once_and_with_its_block(make_sample: MakeSample):
    """Blocks of 25 frames go to five folds in turn; of several logs each is a fold."""
    frames = make_sample(frames=150)
    folds = folds_of(frames, "blocks")
    assert np.sum(folds, axis=0).tolist() == [1] * 150
    assert np.flatnonzero(folds[0]).tolist() == [*range(25), *range(125, 150)]
    three = Sample(frames.names, frames.predictors, frames.time_ms, np.repeat([0, 1, 2], 50))
    assert [np.flatnonzero(fold)[0] for fold in folds_of(three, "logs")] == [0, 50, 100]


def test_frames_of_one_view_are_held_out_together(make_sample: MakeSample):
    """Of a path drawn twice in shuffled order, a block is one of the path, in both passes."""
    frames = make_sample(frames=200)
    path = np.concatenate([np.random.default_rng(one).permutation(100) for one in (1, 2)])
    shuffled = dataclasses.replace(frames, path=path)
    for held in folds_of(shuffled, "blocks"):
        assert set(path[held]).isdisjoint(path[~held])


@pytest.mark.slow
def test_the_error_of_the_mean_is_that_of_blocks(make_sample: MakeSample):
    """Over twelve logs the mean error is inside twice its standard error, mostly."""
    inside = 0
    for seed in range(12):
        found = hold_out(make_sample("correlated", seed=seed), TERMS, "gaussian", SHORT, "blocks")
        assert found.folds == 5
        inside += abs(found.error_pct_mean) < 2.0 * found.error_pct_mean_se
    assert inside >= 8


@pytest.mark.slow
def test_few_frames_are_left_out_by_weights(make_sample: MakeSample):
    """Weighted samples of the whole fit say what the fits without each frame say."""
    frames = make_sample(frames=20)
    options = SamplerOptions()
    whole = estimate(frames, TERMS, "gaussian", options)
    fast = hold_out(frames, TERMS, "gaussian", options, "leave-one-out", whole=whole)
    slow = hold_out(frames, TERMS, "gaussian", options, "leave-one-out")
    assert fast.error_pct_mean == pytest.approx(slow.error_pct_mean, abs=0.1)
    assert fast.error_pct_sd == pytest.approx(slow.error_pct_sd, rel=0.05)
    assert fast.log_score == pytest.approx(slow.log_score, abs=0.05)


def test_a_model_that_does_not_predict_is_unfit():
    """Each bound by itself: a mean error that is no chance, scatter, and coverage."""
    good = HeldOut("blocks", 100, 3.0, 9.0, (0.0,) * 5, 0.9, 0.0, error_pct_mean_se=1.0)
    assert good.unfit == ""
    replace = dataclasses.replace
    assert "is off by +71.0 %" in replace(good, error_pct_total=71.0).unfit
    assert replace(good, error_pct_mean=11.0, error_pct_total=1.0).unfit == ""  # of noise alone
    assert replace(good, error_pct_mean=12.0, error_pct_mean_se=7.0).unfit == ""
    assert "errors scatter by 93 %" in replace(good, error_pct_sd=93.0).unfit
    assert "90 % intervals hold 40%" in replace(good, coverage_90=0.4).unfit


def test_errors_are_those_of_the_noise(make_sample: MakeSample):
    """Of 6 % noise: no bias, a deviation of 6 %, 90 % coverage, and the noise's own log score."""
    frames = make_sample("heteroscedastic", frames=1_000)
    found = hold_out(frames, TERMS, "student-t", SHORT, "blocks")
    assert found.rows == 1000
    assert abs(found.error_pct_mean) < 1.5
    assert found.error_pct_sd == pytest.approx(6.0, rel=0.15)
    assert found.error_pct_quantiles[2] == pytest.approx(0.0, abs=1.0)
    assert found.coverage_90 == pytest.approx(0.9, abs=0.04)
    mean = 4.0 + frames.predictors @ np.array([0.02, 5e-6])
    best: Any = stats.norm.logpdf(frames.time_ms, mean, 0.06 * mean)
    assert found.log_score == pytest.approx(float(best.mean()), abs=0.03)


@pytest.mark.slow
def test_fits_side_by_side_are_those_one_after_the_other(make_sample: MakeSample):
    """Eight fits on one and on three worker processes: every number of the summary is the same."""
    frames, short = make_sample(frames=8), SamplerOptions(max_steps=20)
    alone = hold_out(frames, TERMS, "student-t", short, "leave-one-out")
    assert hold_out(frames, TERMS, "student-t", short, "leave-one-out", workers=3) == alone


def test_a_fit_that_cannot_be_done_is_refused(make_sample: MakeSample):
    """Four frames less one are too few for three coefficients and the noise."""
    with pytest.raises(InputError, match="expected at least 5 frames for 3 coefficients"):
        hold_out(make_sample(frames=4), TERMS, "gaussian", SHORT, "auto")


def test_frames_of_one_place_cannot_be_held_out(make_sample: MakeSample):
    """Each drawn in a pass of its own, which leaves nothing to fit to."""
    frames = make_sample(frames=100)
    of_one_place = dataclasses.replace(frames, path=np.zeros(100, dtype=np.int64))
    with pytest.raises(InputError, match="expected frames of several places on the path"):
        hold_out(of_one_place, TERMS, "student-t", SHORT, "blocks")


def test_each_frame_in_turn_where_there_are_few(make_sample: MakeSample):
    """Twelve frames are left out one by one; of many that is refused."""
    found = hold_out(make_sample(frames=12), TERMS, "gaussian", SHORT, "auto")
    assert (found.split, found.rows) == ("leave-one-out", 12)
    with pytest.raises(InputError, match="expected at most 400 frames"):
        hold_out(make_sample(frames=500), TERMS, "gaussian", SHORT, "leave-one-out")


def test_another_log_is_predicted_with_its_bias(make_sample: MakeSample):
    """A machine that is 25 % slower is predicted 20 % too fast."""
    fitted = estimate(make_sample(), TERMS, "gaussian", SHORT)
    frames = make_sample(seed=1)
    slower = Sample(frames.names, frames.predictors, 1.25 * frames.time_ms, frames.series)
    found = judge(fitted, slower, "slower")
    assert found.split == "slower"
    assert found.error_pct_mean == pytest.approx(-20.0, abs=0.7)
    assert found.coverage_90 < 0.2


def test_an_unknown_split_is_refused(make_sample: MakeSample):
    """The known ones are listed."""
    with pytest.raises(InputError, match="expected one of blocks, halves"):
        hold_out(make_sample(), TERMS, "gaussian", SHORT, "thirds")


def test_predictions_have_the_density_that_they_are_scored_by(make_sample: MakeSample):
    """The log density of one draw is Student's t; of two, the mean of densities."""
    frames = make_sample(frames=50)
    design = design_of(frames, TERMS)
    theta = np.array([[4.0, 4.5, 5.5, -0.7, 0.4, 0.2], [4.0, 4.4, 5.6, -0.5, 0.2, 0.3]])
    names = (*design.names, "log_scale", "growth", "inverse_dof")
    each = [
        Draws(names, row[np.newaxis], 12.0).log_density(design, frames.time_ms) for row in theta
    ]
    mean = design.mean(theta[:1, :3])[0]
    scale = np.exp(-0.7) * (0.6 + 0.4 * mean / 12.0)
    assert each[0] == pytest.approx(stats.t.logpdf(frames.time_ms, 5.0, mean, scale))
    both = Draws(names, theta, 12.0).log_density(design, frames.time_ms)
    assert np.exp(both) == pytest.approx(0.5 * (np.exp(each[0]) + np.exp(each[1])))


def test_simulated_times_have_the_model_s_spread(make_sample: MakeSample):
    """Residuals of many simulated frames over their scale are Student's t of the draw's dof."""
    frames = make_sample(frames=4_000)
    design = design_of(frames, TERMS)
    draws = Draws(
        (*design.names, "log_scale", "growth", "inverse_dof"),
        np.array([[4.0, 4.5, 5.5, -0.7, 0.4, 0.25]]),
        12.0,
    )
    mean, simulated = draws.simulate(design, np.random.default_rng(0))
    _, scale = draws.moments(design)
    z = ((simulated - mean) / scale)[0]
    assert stats.kstest(z, stats.t(4.0).cdf).pvalue > 0.01


def test_predictive_checks_see_what_the_model_does_not_make(make_sample: MakeSample):
    """Right model: p about 0.5 over logs.  Correlated frames, outliers: seen by name."""
    rng = np.random.default_rng(3)

    def p_of(kind: str, model: str, seed: int = 0) -> dict[str, float]:
        frames = make_sample(kind, frames=400, seed=seed)
        name = "student-t" if model == "student-t" else "gaussian"
        found = estimate(frames, TERMS, name, SHORT)
        checks = check_predictive(found.draws, found.design, frames.time_ms, rng)
        return {check.statistic.split()[0]: check.p for check in checks}

    right = [p_of("clean", "gaussian", seed) for seed in range(6)]
    for statistic in right[0]:
        assert 0.2 < np.mean([found[statistic] for found in right]) < 0.8
    assert p_of("correlated", "gaussian")["correlation"] < 0.01
    assert p_of("outliers", "gaussian")["largest"] < 0.01
    assert p_of("heteroscedastic", "student-t")["spread"] > 0.01
