"""Likelihoods and priors against scipy's densities, row by row."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats

from lodbench.analysis.fit.design import design_of
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.sampling.likelihood import GaussianLikelihood, StudentLikelihood
from lodbench.analysis.fit.sampling.optimum import expand
from lodbench.analysis.fit.sampling.posterior import LogPosterior
from lodbench.analysis.fit.sampling.priors import Priors
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.arrays import FloatArray

MakeSample = Callable[..., Sample]

TERMS = ("draw_calls,triangles", "draw_calls,max(triangles,shaded_samples)")


def with_samples(sample: Sample) -> Sample:
    """Add a column of samples that is the larger side in about half of the frames."""
    shaded = np.random.default_rng(8).permutation(sample.column("triangles"))
    return Sample(
        (*sample.names, "shaded_samples"),
        np.column_stack([sample.predictors, shaded]),
        sample.time_ms,
        sample.series,
    )


def some_theta(width: int, noise: tuple[float, ...]) -> FloatArray:
    """Return five parameter vectors inside the bounds."""
    rng = np.random.default_rng(4)
    return np.hstack([rng.uniform(2.0, 8.0, (5, width)), np.tile(noise, (5, 1))])


@pytest.mark.parametrize("terms", TERMS)
@pytest.mark.parametrize("frames", [9, 150])
def test_gaussian_likelihood_is_the_sum_of_log_densities(
    make_sample: MakeSample, terms: str, frames: int
):
    """Sufficient statistics give what every row gives, to rounding."""
    sample = with_samples(make_sample(frames=frames))
    design = design_of(sample, parse_terms(terms))
    theta = some_theta(len(design.names), (0.3,))
    found = GaussianLikelihood(design, sample.time_ms)(theta)
    for row, value in zip(theta, found, strict=True):
        mean = design.mean(row[np.newaxis, :-1])[0]
        expected: Any = stats.norm.logpdf(sample.time_ms, mean, np.exp(0.3))
        assert value == pytest.approx(float(expected.sum()), rel=1e-12)


@pytest.mark.parametrize("terms", TERMS)
@pytest.mark.parametrize("frames", [3, 8, 150])
def test_student_likelihood_is_the_sum_of_log_densities(
    make_sample: MakeSample, terms: str, frames: int
):
    """Products of eight before each logarithm give what every row gives, also of few rows."""
    sample = with_samples(make_sample(frames=frames))
    design = design_of(sample, parse_terms(terms))
    theta = some_theta(len(design.names), (-0.5, 0.3, 0.25))
    found = StudentLikelihood(design, sample.time_ms, 12.0)(theta)
    for row, value in zip(theta, found, strict=True):
        mean = design.mean(row[np.newaxis, :-3])[0]
        scale = np.exp(-0.5) * (0.7 + 0.3 * mean / 12.0)
        expected: Any = stats.t.logpdf(sample.time_ms, 4.0, loc=mean, scale=scale)
        assert value == pytest.approx(float(expected.sum()), rel=1e-12)


def test_blocks_of_walkers_change_nothing(make_sample: MakeSample):
    """Vectors that do not fit one block are each what they are alone."""
    sample = make_sample(frames=9_000)
    design = design_of(sample, parse_terms(TERMS[0]))
    likelihood = StudentLikelihood(design, sample.time_ms, 12.0)
    theta = some_theta(3, (-0.5, 0.3, 0.25))
    alone = [float(likelihood(row[np.newaxis])[0]) for row in theta]
    assert likelihood(theta) == pytest.approx(np.array(alone), rel=1e-13)


def test_the_posterior_adds_priors_and_knows_its_bounds(make_sample: MakeSample):
    """Half-normal, half-normal with the Jacobian of a logarithm, and gamma on dof, by scipy."""
    sample = make_sample()
    design = design_of(sample, parse_terms(TERMS[0]))
    likelihood = StudentLikelihood(design, sample.time_ms, 12.0)
    posterior = LogPosterior(likelihood, Priors(12.0))
    theta = some_theta(3, (-0.5, 0.3, 0.25))

    def prior(row: FloatArray) -> float:
        dof = 1.0 / float(row[5])
        parts: list[Any] = [
            *stats.halfnorm.logpdf(row[:3], scale=24.0),
            stats.halfnorm.logpdf(np.exp(row[3]), scale=12.0),
            row[3],
            stats.gamma.logpdf(dof, 2.0, scale=10.0),
            2.0 * np.log(dof),
        ]
        return float(sum(parts))

    theta[1:, 5], theta[2:, 3] = 0.5, 0.7
    expected = np.array([prior(row) for row in theta]) + likelihood(theta)
    found = posterior(theta)
    assert found - found[0] == pytest.approx(expected - expected[0], rel=1e-9)
    outside = np.tile(theta[0], (4, 1))
    outside[0, 1], outside[1, 4], outside[2, 5], outside[3, 5] = -1e-9, 1.01, 1.01, 1e-3
    assert np.isneginf(posterior(outside)).all()


def test_absurd_proposals_are_impossible_and_not_an_error(make_sample: MakeSample):
    """A scale of a millionth of a nanosecond overflows to a log density of minus infinity."""
    sample = make_sample()
    likelihood = StudentLikelihood(design_of(sample, parse_terms(TERMS[0])), sample.time_ms, 12.0)
    theta = np.array([[4.0, 4.0, 4.0, -200.0, 0.5, 0.9]])
    assert np.isneginf(likelihood(theta)).all()


def test_an_expansion_of_a_quadratic_is_the_quadratic():
    """Value, gradient and curvature of a bowl, also where the centre lies on a bound."""
    curvature = np.array([[4.0, 1.0], [1.0, 9.0]])

    def bowl(theta: FloatArray) -> FloatArray:
        away = theta - np.array([1.0, 2.0])
        return 5.0 - 0.5 * np.einsum("wi,ij,wj->w", away, curvature, away)

    for center in (np.array([1.0, 2.0]), np.array([0.0, 2.0])):
        found = expand(bowl, center, np.zeros(2), np.full(2, np.inf))
        assert found.hessian == pytest.approx(-curvature, rel=1e-6)
        away = found.center - np.array([1.0, 2.0])
        assert found.gradient == pytest.approx(-curvature @ away, abs=1e-6)
