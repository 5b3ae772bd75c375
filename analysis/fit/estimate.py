"""From frames and terms to a sampled posterior: what a fit and each held-out fit have in common."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .assessment.dependence import Frames, dependence
from .assessment.posterior_predictive import Draws
from .design import Design, design_of
from .fit_frames import Sample
from .sampling.likelihood import (
    GaussianLikelihood,
    Likelihood,
    QuadraticLikelihood,
    StudentLikelihood,
)
from .sampling.optimum import highest, quadratic, starts
from .sampling.posterior import LogPosterior
from .sampling.priors import Priors
from .sampling.sampler import Chain, Progress, SamplerOptions
from .sampling.sampler import sample as sample_chain
from .sampling.stretch import Stretch
from .terms import Term

Model = Literal["student-t", "gaussian"]

MANY_FRAMES = 20_000  # above, a likelihood that must visit each frame is taken to second order

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
        """Independent frames that would tell as much of the mean frame's cost."""
        stretch = self.posterior.stretch
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
    found = dependence(_frames(sample, design, center, posterior.likelihood))
    stretch = Stretch.of(found, center, posterior.likelihood)
    posterior = LogPosterior(posterior.likelihood, priors, stretch)
    return design, posterior, highest(posterior, [center])


def _frames(sample: Sample, design: Design, theta: FloatArray, likelihood: Likelihood) -> Frames:
    """Return a sample about the optimum of its likelihood."""
    draws = Draws(likelihood.names, theta[np.newaxis], float(sample.time_ms.mean()))
    mean, scale = (moment[0] for moment in draws.moments(design))
    slopes = design.slopes(theta[: len(design.names)])
    dof = None if "inverse_dof" not in likelihood.names else float(draws.dof[0])
    return Frames(slopes, mean, np.asarray(scale), sample.time_ms, sample.series, dof)


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
    return Estimate(sample, tuple(terms), design, posterior, chain)
