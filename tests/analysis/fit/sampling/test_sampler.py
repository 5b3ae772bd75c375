"""Sampling: against a closed form, plainly written emcee, itself again, and itself interrupted."""

from collections.abc import Callable
from math import lgamma, log, pi
from pathlib import Path
from typing import Any

import emcee
import numpy as np
import pytest

from lodbench.analysis.fit.design import design_of
from lodbench.analysis.fit.estimate import estimate, posterior_of
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.sampling.diagnostics import diagnose, split_r_hat
from lodbench.analysis.fit.sampling.likelihood import GaussianLikelihood
from lodbench.analysis.fit.sampling.posterior import LogPosterior
from lodbench.analysis.fit.sampling.priors import Priors
from lodbench.analysis.fit.sampling.sampler import Chain, SamplerOptions, sample
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")


@pytest.fixture(scope="module")
def short_chain(make_sample: MakeSample) -> Chain:
    """Sample the Gaussian posterior of 150 frames."""
    return estimate(make_sample(), TERMS, "gaussian", SamplerOptions()).chain


class FlatPriors(Priors):
    """Priors that say nothing, so that the posterior is that of least squares."""

    def log_coefficients(self, scaled: FloatArray) -> FloatArray:
        """Return 0 for all coefficients."""
        return np.zeros(len(scaled))

    def log_scale(self, log_scale: FloatArray) -> FloatArray:
        """Return 0 for all scales."""
        return np.zeros(len(log_scale))


def test_mean_and_covariance_are_those_of_the_closed_form(make_sample: MakeSample):
    """Under flat priors coefficients have a multivariate t posterior (Gelman et al., 14.2)."""
    frames = make_sample(frames=60)
    design = design_of(frames, TERMS)
    posterior = LogPosterior(
        GaussianLikelihood(design, frames.time_ms), FlatPriors(float(frames.time_ms.mean()))
    )
    columns = design.columns.T
    inverse = np.linalg.inv(columns.T @ columns)
    solution = inverse @ columns.T @ frames.time_ms
    residual = frames.time_ms - columns @ solution
    variance = float(residual @ residual) / (60 - 3)
    covariance = inverse * variance * 57 / 55
    center = np.array([*solution, 0.5 * log(variance)])
    chain = sample(posterior, center, SamplerOptions(walkers=64, max_steps=20_000, seed=5))
    ess = len(chain.flat) / chain.tau.max()
    found = chain.flat[:, :3]
    deviation = np.sqrt(np.diag(covariance))
    assert ess > 3_000
    assert np.abs(found.mean(axis=0) - solution).max() < 4.0 * (deviation / np.sqrt(ess)).max()
    scaled = np.cov(found, rowvar=False) / np.outer(deviation, deviation)
    expected = covariance / np.outer(deviation, deviation)
    assert scaled == pytest.approx(expected, abs=5.0 * np.sqrt(2.0 / ess))


def plain_log_prob(theta: Any, columns: Any, time_ms: Any) -> float:
    """Return the same posterior density as a beginner would write it, one vector at a time."""
    base, draws, triangles, log_scale, growth, inverse = theta
    if min(base, draws, triangles) < 0 or not 0 <= growth <= 1 or not 1 / 500 <= inverse <= 1:
        return -np.inf
    dof, mean_ms = 1.0 / inverse, time_ms.mean()
    mean = base * columns[0] + draws * columns[1] + triangles * columns[2]
    scale = np.exp(log_scale) * (1.0 - growth + growth * mean / mean_ms)
    each = lgamma(dof / 2 + 0.5) - lgamma(dof / 2) - 0.5 * log(pi * dof)
    z = (time_ms - mean) / scale
    likelihood = np.sum(each - np.log(scale) - (dof + 1) / 2 * np.log1p(z**2 / dof))
    prior = -0.5 * (base**2 + draws**2 + triangles**2) / (2 * mean_ms) ** 2
    prior += log_scale - 0.5 * (np.exp(log_scale) / mean_ms) ** 2
    prior += 3.0 * log(dof) - 0.1 * dof
    return float(likelihood + prior)


@pytest.mark.slow
def test_plain_emcee_finds_the_same_posterior(make_sample: MakeSample):
    """Another move, another start, and no code of ours: means and deviations agree."""
    frames = make_sample("outliers", frames=60)
    design, posterior, center = posterior_of(frames, TERMS, "student-t")
    ours = sample(
        LogPosterior(posterior.likelihood, posterior.priors),
        center,
        SamplerOptions(max_steps=6_000),
    )
    np.random.seed(3)  # noqa: NPY002  # emcee's plain interface draws from the global state
    start = center + 0.01 * np.random.standard_normal((32, 6))  # noqa: NPY002  # as above
    start = np.clip(start, [0, 0, 0, -9, 0.01, 0.003], [99, 99, 99, 9, 0.99, 0.99])
    start += 1e-4 * np.random.random((32, 6))  # noqa: NPY002  # as above
    sampler: Any = emcee.EnsembleSampler(
        32, 6, plain_log_prob, args=(design.columns, frames.time_ms)
    )
    sampler.run_mcmc(start, 3_000)
    theirs = np.asarray(sampler.get_chain(discard=600, flat=True))
    tau = float(sampler.get_autocorr_time(discard=600, tol=0).max())
    error = np.sqrt(tau / len(theirs) + ours.tau.max() / len(ours.flat))
    deviation = theirs.std(axis=0)
    assert (
        np.abs(ours.flat.mean(axis=0) - theirs.mean(axis=0)).max() < (5 * error * deviation).max()
    )
    assert ours.flat.std(axis=0) / deviation == pytest.approx(np.ones(6), abs=6.0 * error)


def test_the_same_seed_gives_the_same_chain_and_another_seed_another(make_sample: MakeSample):
    """Bit for bit, whatever the global random state."""
    frames = make_sample()
    chains: list[Any] = []
    for seed in (1, 1, 2):
        np.random.seed(seed + 10)  # noqa: NPY002  # must not matter
        options = SamplerOptions(max_steps=250, seed=seed)
        chains.append(estimate(frames, TERMS, "student-t", options).chain.samples)
    assert np.array_equal(chains[0], chains[1])
    assert not np.array_equal(chains[0], chains[2])


class Interrupted(Exception):  # noqa: N818  # an event, not an error
    """Raised in the middle of sampling."""


def test_an_interrupted_chain_goes_on_to_the_same_end(make_sample: MakeSample, tmp_path: Path):
    """Stopped after 500 steps and resumed, it is the chain without interruption."""
    frames = make_sample()
    options = SamplerOptions(max_steps=1_500)

    def stop(steps: int, _most: int) -> None:
        if steps >= 500:
            raise Interrupted

    whole = estimate(frames, TERMS, "student-t", options).chain
    resume = tmp_path / "chain.npz", "this fit"
    with pytest.raises(Interrupted):
        estimate(frames, TERMS, "student-t", options, resume=resume, progress=stop)
    rest = estimate(frames, TERMS, "student-t", options, resume=resume).chain
    assert np.array_equal(rest.samples, whole.samples)
    assert rest.acceptance == whole.acceptance
    again = estimate(frames, TERMS, "student-t", options, resume=resume).chain
    assert np.array_equal(again.samples, whole.samples)
    assert [path.name for path in tmp_path.iterdir()] == ["chain.npz"]


@pytest.mark.parametrize("content", [b"", b"not a chain", b"PK\x03\x04 cut off"])
def test_what_is_no_chain_is_not_gone_on_with(
    make_sample: MakeSample, tmp_path: Path, content: bytes
):
    """A file of something else is refused, and left as it is."""
    path = tmp_path / "chain.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match="got another kind of file"):
        estimate(make_sample(), TERMS, "gaussian", SamplerOptions(), resume=(path, "a"))
    assert path.read_bytes() == content


def test_a_chain_of_another_fit_is_not_gone_on_with(make_sample: MakeSample, tmp_path: Path):
    """The file knows what it is of."""
    path, options = tmp_path / "chain.npz", SamplerOptions(max_steps=40)
    estimate(make_sample(), TERMS, "gaussian", options, resume=(path, "a"))
    with pytest.raises(InputError, match="got one of others; name another file"):
        estimate(make_sample(), TERMS, "gaussian", options, resume=(path, "b"))


def test_the_chain_is_long_enough_or_says_that_it_is_not(
    make_sample: MakeSample, short_chain: Chain
):
    """Sampling goes on to fifty autocorrelation times; stopped before, the diagnosis is doubt."""
    good = diagnose(short_chain)
    assert good.lengths >= 50.0
    assert good.doubt == ""
    cut = estimate(make_sample(), TERMS, "gaussian", SamplerOptions(max_steps=60)).chain
    assert "fewer than 50" in diagnose(cut).doubt


def test_autocorrelation_time_and_ess_are_those_of_a_known_process():
    """An autoregression with 0.9 has an autocorrelation time of 19 steps."""
    rng = np.random.default_rng(7)
    steps, walkers = 5_000, 16
    series = np.zeros((steps, walkers, 1))
    for k in range(1, steps):
        series[k] = 0.9 * series[k - 1] + rng.standard_normal((walkers, 1))
    tau = emcee.autocorr.integrated_time(series, tol=0)
    found = diagnose(Chain(("x",), series, 0.3, np.asarray(tau)))
    assert found.autocorr_time == pytest.approx(19.0, rel=0.1)
    assert found.ess == pytest.approx(steps * walkers / 19.0, rel=0.1)
    assert found.r_hat < 1.01


def test_split_r_hat_sees_groups_that_disagree_and_halves_that_drift():
    """One group of walkers elsewhere, or a trend, is seen; noise alone is not."""
    noise = np.random.default_rng(1).standard_normal((1_000, 8, 2))
    assert split_r_hat(noise).max() < 1.01
    stuck = noise.copy()
    stuck[:, 3, 1] += 8.0
    assert split_r_hat(stuck)[0] < 1.01
    assert split_r_hat(stuck)[1] > 1.2
    drift = noise + np.linspace(0.0, 3.0, 1_000)[:, np.newaxis, np.newaxis]
    assert split_r_hat(drift).min() > 1.2


def test_groups_of_walkers_that_disagree_are_doubt():
    """A long chain is not trusted where R-hat is high."""
    noise = np.random.default_rng(1).standard_normal((1_000, 8, 1))
    noise[:, 3] += 8.0
    assert "split R-hat" in diagnose(Chain(("x",), noise, 0.3, np.ones(1))).doubt


def test_thinned_draws_are_spread_over_the_chain(short_chain: Chain):
    """First and last sample are among them, and no more are given than there are."""
    draws = short_chain.thinned(64)
    assert draws.shape == (64, 4)
    assert np.array_equal(draws[0], short_chain.flat[0])
    assert np.array_equal(draws[-1], short_chain.flat[-1])
    assert len(short_chain.thinned(10**9)) == len(short_chain.flat)


def test_a_fit_needs_more_frames_than_coefficients(make_sample: MakeSample):
    """Four frames are too few for three coefficients and noise."""
    with pytest.raises(InputError, match="expected at least 5 frames for 3 coefficients, got 4"):
        estimate(make_sample(frames=4), TERMS, "gaussian", SamplerOptions())


def test_a_roofline_is_found_again(make_sample: MakeSample):
    """Of max(triangles, samples) both sides are recovered, if each is the larger at times."""
    frames = make_sample(seed=2, frames=400)
    rng = np.random.default_rng(3)
    shaded = rng.uniform(0.0, 2e6, 400)
    triangles = frames.column("triangles")
    mean = 2.0 + np.maximum(5e-6 * triangles, 8e-6 * shaded)
    frames = Sample(
        ("triangles", "shaded_samples"),
        np.column_stack([triangles, shaded]),
        mean * (1.0 + 0.03 * rng.standard_normal(400)),
        frames.series,
    )
    terms = parse_terms("max(triangles,shaded_samples)")
    found = estimate(frames, terms, "student-t", SamplerOptions()).coefficients_ms
    low, high = np.quantile(found, (0.005, 0.995), axis=0)
    truth = np.array([2.0, 5e-6, 8e-6])
    assert ((low < truth) & (truth < high)).all()
    assert (found.std(axis=0) / truth).max() < 0.05
