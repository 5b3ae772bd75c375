"""Predictions of each frame by a fit to all others, where there are few."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ...study.engine.limits import Limits
from ...study.engine.open_engine import open_engine
from ...study.engine.task import Beat, Inputs
from ..estimate import Estimate, Model, estimate
from ..fit_frames import Sample
from ..sampling.sampler import SamplerOptions
from ..terms import Term
from .prediction import predict, predict_by

FEW = 40
"""Frames, up to which each is left out in turn."""

_WEIGHED, _KEPT = 4_000, 1_000  # samples
_ENOUGH = 0.1  # of the weighted samples, effective ones
_SAMPLE = "sample"
_PATIENT = Limits(timeout_s=1e7)  # a chain is as long as it has to be


def leave_one_out(
    sample: Sample,
    terms: Sequence[Term],
    model: Model,
    options: SamplerOptions,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    whole: Estimate | None = None,
) -> list[tuple[FloatArray, float]]:
    """Return what `predict` says of each frame by a fit without it; arguments as of `hold_out`."""
    if len(sample) > 10 * FEW:
        raise InputError(
            f"--heldout leave-one-out: expected at most {10 * FEW} frames, since each is one "
            f"fit, got {len(sample)}; use blocks"
        )
    known = {} if whole is None or len(sample) > FEW else _reweighted(whole, sample)
    rows = [row for row in range(len(sample)) if row not in known]
    tasks = [LeftOut(row, tuple(terms), model, options) for row in rows]
    if tasks:
        found = _side_by_side(tasks, sample, workers, scheduler)
        known |= dict(zip(rows, found, strict=True))
    return [known[row] for row in range(len(sample))]


def _reweighted(whole: Estimate, sample: Sample) -> dict[int, tuple[FloatArray, float]]:
    """Return predictions of rows from weighted samples of the fit to all, where these suffice.

    A sample counts for one over the density that it gives the row, up to the truncation of Ionides
    (J. Computational and Graphical Statistics 17, 2008).
    """
    rng, found = np.random.default_rng(0), dict[int, tuple[FloatArray, float]]()
    theta = whole.chain.thinned(_WEIGHED)
    all_draws = replace(whole.draws, theta=theta)
    for row in range(len(sample)):
        one = sample.rows(np.arange(len(sample)) == row)
        density = all_draws.each_log_density(whole.design.rows(np.array([row])), one.time_ms)[:, 0]
        weight: FloatArray = np.exp(density.min() - density)
        weight = np.minimum(weight, weight.mean() * np.sqrt(len(weight)))
        weight /= weight.sum()
        if 1.0 / float(weight @ weight) >= _ENOUGH * len(weight):
            places = np.searchsorted(np.cumsum(weight), (np.arange(_KEPT) + rng.random()) / _KEPT)
            kept = theta[np.minimum(places, len(theta) - 1)]
            found[row] = predict_by(replace(all_draws, theta=kept), whole, one)
    return found


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A fit to all frames but one, which predicts that one: a `Task` of the study's engine."""

    row: int
    terms: tuple[Term, ...]
    model: Model
    options: SamplerOptions

    result_type: ClassVar[Any] = tuple[FloatArray, float]

    @property
    def owner(self) -> str:
        """The fit, of which there is one (see `Task`)."""
        return "fit"

    def __call__(self, inputs: Inputs, beat: Beat) -> tuple[FloatArray, float]:
        """Return what `predict` does (see `Task`)."""
        sample: Sample = inputs[_SAMPLE]
        others = np.arange(len(sample)) != self.row

        def tell(steps: int, _most: int) -> None:
            beat(steps)

        kept = sample.rows(others)
        fitted = estimate(kept, self.terms, self.model, self.options, progress=tell)
        return predict(fitted, sample.rows(~others))


def _side_by_side(
    tasks: Sequence[LeftOut], sample: Sample, workers: int, scheduler: str | None
) -> list[tuple[FloatArray, float]]:
    """Return what each task results in, in their order.

    Worker processes even for one worker: they calculate with one thread, and the optimum that a
    chain starts from differs in its last digits with the number of threads of LAPACK.
    """
    found: dict[int, tuple[FloatArray, float]] = {}
    inputs = {_SAMPLE: sample}
    with open_engine(inputs, workers=workers, limits=_PATIENT, scheduler=scheduler) as engine:
        for outcome in engine.run(tasks):
            if outcome.failure is not None:
                raise InputError(
                    "--heldout leave-one-out: expected a fit without each frame, got "
                    f"{outcome.failure.reason} without frame {outcome.index}; use --workers 1"
                )
            found[outcome.index] = outcome.result
    return [found[index] for index in range(len(tasks))]
