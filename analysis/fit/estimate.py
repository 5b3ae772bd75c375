"""From frames and terms to a sampled posterior: what a fit and each held-out fit have in common."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .assessment.dependence import Frames, dependence, rise_of
from .assessment.posterior_predictive import Draws
from .design import Design, design_of
from .fit_frames import Sample
from .log_summary import summary_of
from .sampling.between_logs import (
    OCCASION,
    OCCASION_SCALE,
    SCENE_SCALE,
    BetweenLogs,
    Levels,
    LogSummary,
)
from .sampling.likelihood import (
    GaussianLikelihood,
    Likelihood,
    QuadraticLikelihood,
    StudentLikelihood,
)
from .sampling.optimum import expand, highest, highest_of, quadratic, starts
from .sampling.posterior import LogPosterior
from .sampling.priors import Priors
from .sampling.sampler import Chain, Progress, SamplerOptions
from .sampling.sampler import sample as sample_chain
from .sampling.stretch import Stretch
from .terms import Term

Model = Literal["student-t", "gaussian"]

MANY_FRAMES = 20_000  # above, a likelihood that must visit each frame is taken to second order

_AT_BOUND = 1e-6  # of the largest coefficient, up to which one is held by its bound
_START = 0.7  # of the scale of a spread's prior, its median, where the search begins
_KEPT = 1_000  # samples kept for predictions


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """A sampled posterior and what it was sampled from."""

    sample: Sample
    terms: tuple[Term, ...]
    design: Design
    posterior: LogPosterior
    chain: Chain

    @property
    def draws(self) -> Draws:
        """Samples for predictions, thinned."""
        return Draws(self.chain.names, self.chain.thinned(_KEPT), self.posterior.priors.mean_ms)

    @property
    def likelihood_is(self) -> str:
        """How the likelihood visits the frames, in words."""
        if isinstance(self.posterior.likelihood, QuadraticLikelihood):
            return "all frames to second order about the optimum"
        if isinstance(self.posterior.likelihood, GaussianLikelihood) and self.design.linear:
            return "sufficient statistics of all frames"
        return "every frame"

    @property
    def rows_worth(self) -> float:
        """Independent frames that would tell as much of a common factor of all costs."""
        stretch, likelihood = self.posterior.stretch, self.posterior.likelihood
        if isinstance(likelihood, BetweenLogs):
            return len(self.sample) * likelihood.worth
        return len(self.sample) * (1.0 if stretch is None else 1.0 / float(stretch.found.times[0]))

    @property
    def coefficients_ms(self) -> FloatArray:
        """Coefficients in milliseconds per unit of their predictors, (S, K), of all samples."""
        return self.chain.flat[:, : len(self.design.names)] / self.design.unit


def posterior_of(
    sample: Sample, terms: Sequence[Term], model: Model
) -> tuple[Design, LogPosterior, FloatArray]:
    """Return design, log-posterior and its optimum.

    Raises `InputError` if there are too few frames, or a column is constant.
    """
    design = design_of(sample, terms)
    if len(sample) < len(design.names) + 2:
        raise InputError(
            f"expected at least {len(design.names) + 2} frames for {len(design.names)} "
            f"coefficients, got {len(sample)}; log for longer, or fit fewer terms"
        )
    mean_ms = float(sample.time_ms.mean())
    priors = Priors(mean_ms)

    def likelihood_of(part: Design, time_ms: FloatArray) -> Likelihood:
        if model == "gaussian":
            return GaussianLikelihood(part, time_ms)
        return StudentLikelihood(part, time_ms, mean_ms)

    visited = model == "student-t" or not design.linear
    every = slice(None, None, max(1, -(-len(sample) // MANY_FRAMES)) if visited else 1)
    which = np.arange(len(sample))[every]
    few = likelihood_of(design.rows(which), sample.time_ms[which])
    given = starts(design.rows(which), sample.time_ms[which], few)
    center = highest(LogPosterior(few, priors), given)
    posterior = LogPosterior(few, priors)
    if len(which) < len(sample):
        whole = LogPosterior(likelihood_of(design, sample.time_ms), priors)
        posterior = quadratic(whole, center)
        center = highest(posterior, [center])
    levels = Levels.of(
        [sample.origin(log) for log in np.unique(sample.series).tolist()], design.names
    )
    if levels:
        several = _between_logs(sample, design, center, posterior.likelihood, levels)
        posterior = LogPosterior(several, priors)
        spreads = [
            _START * (OCCASION_SCALE if name == OCCASION else SCENE_SCALE) for name in levels.names
        ]
        return design, posterior, highest(posterior, [np.concatenate([center, spreads])])
    return design, *_stretched(sample, design, center, posterior)


def _stretched(
    sample: Sample, design: Design, center: FloatArray, posterior: LogPosterior
) -> tuple[LogPosterior, FloatArray]:
    """Return the posterior of frames that err alike, and its optimum.

    It is stretched about where the frames alone have it, be that beyond a bound: else the slope at
    the bound would be taken for surer than the frames are.
    """
    likelihood = posterior.likelihood
    free = _unbounded(likelihood, design, center)
    found = dependence(_frames(sample, design, free, likelihood))
    stretch = Stretch.of(found, free, likelihood)
    posterior = LogPosterior(likelihood, posterior.priors, stretch)
    inside = np.clip(stretch.moved, likelihood.low, likelihood.high)
    return posterior, highest(posterior, [inside])


def _unbounded(likelihood: Likelihood, design: Design, center: FloatArray) -> FloatArray:
    """Return the optimum of a likelihood if coefficients may be negative; not those of sides."""
    scaled = center[: len(design.names)]
    if not design.linear or scaled.min() > _AT_BOUND * scaled.max():
        return center
    low = likelihood.low.copy()
    low[: len(design.names)] = -np.inf
    return highest_of(likelihood, low, likelihood.high, [center])


def _between_logs(
    sample: Sample, design: Design, center: FloatArray, likelihood: Likelihood, levels: Levels
) -> BetweenLogs:
    """Return the likelihood of several logs, about the optimum of all of them."""
    whole = _frames(sample, design, center, likelihood)
    growth = float(center[likelihood.names.index("growth")]) if whole.dof is not None else 0.0
    reference_ms, pooled = float(sample.time_ms.mean()), center[: len(design.names)]
    mean, summaries, times = np.empty(len(sample)), list[LogSummary](), 0.0
    for log in np.unique(sample.series).tolist():
        rows = np.flatnonzero(sample.series == log)
        own = summary_of(whole.rows(rows), growth, reference_ms, pooled, sample.origin(log))
        summaries.append(own[0])
        mean[rows] = own[1]
        times += float(own[2].times.min()) * len(rows) / len(sample)
    noise = _noise_about(mean, sample.time_ms, likelihood, center)
    return BetweenLogs(summaries, levels, design.names, pooled, noise, 1.0 / times)


def _noise_about(
    mean: FloatArray, time_ms: FloatArray, likelihood: Likelihood, center: FloatArray
) -> QuadraticLikelihood:
    """Return the likelihood of the noise alone, to second order about its optimum.

    It has three parameters at most, which thousands of frames tell well.
    """
    about = Design(("mean",), np.ones(1), mean[np.newaxis], 1)
    students = "inverse_dof" in likelihood.names
    whole: Likelihood = (
        StudentLikelihood(about, time_ms, float(time_ms.mean()))
        if students
        else GaussianLikelihood(about, time_ms)
    )

    def of_noise(theta: FloatArray) -> FloatArray:
        return whole(np.column_stack([np.ones(len(theta)), theta]))

    names, low, high = whole.names[1:], whole.low[1:], whole.high[1:]
    start = center[[likelihood.names.index(name) for name in names]]
    best = highest_of(of_noise, low, high, [start])
    return QuadraticLikelihood(names, low, high, expand(of_noise, best, low, high))


def _frames(sample: Sample, design: Design, theta: FloatArray, likelihood: Likelihood) -> Frames:
    """Return a sample about the optimum of its likelihood."""
    draws = Draws(likelihood.names, theta[np.newaxis], float(sample.time_ms.mean()))
    mean, scale = (moment[0] for moment in draws.moments(design))
    scaled = theta[: len(design.names)]
    dof = None if "inverse_dof" not in likelihood.names else float(draws.dof[0])
    return Frames(
        scaled, design.slopes(scaled), mean, np.asarray(scale), sample.time_ms, sample.series, dof
    )


def estimate(
    sample: Sample,
    terms: Sequence[Term],
    model: Model,
    options: SamplerOptions,
    *,
    resume: tuple[Path, str] | None = None,
    progress: Progress | None = None,
) -> Estimate:
    """Sample the posterior of a model given frames; raises InputError as `posterior_of`."""
    design, posterior, center = posterior_of(sample, terms, model)
    chain = sample_chain(posterior, center, options, resume=resume, progress=progress)
    if posterior.stretch is not None:
        chain = _mean_kept(chain, sample, design, posterior.likelihood)
    return Estimate(sample, tuple(terms), design, posterior, chain)


def _mean_kept(chain: Chain, sample: Sample, design: Design, likelihood: Likelihood) -> Chain:
    """Return a chain whose mean has the mean frame's cost as it was measured, spikes aside.

    Where coefficients meet their bound at 0, what is left of the posterior costs more on average
    than the frames did, which is what they tell best: a common factor takes it back.
    """
    rise = rise_of(_frames(sample, design, chain.flat.mean(axis=0), likelihood))
    samples = chain.samples.copy()
    samples[..., : len(design.names)] *= 1.0 + rise
    return replace(chain, samples=samples)
