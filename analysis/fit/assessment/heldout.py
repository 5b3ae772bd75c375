"""How well a model predicts frames that it was not fitted to.

Successive frames err alike, so a frame between two fitted ones is no test; blocks of successive
frames of the path are held out, a fifth of them at a time, so that each frame is predicted once.
Halves are the stricter test of a log whose conditions drift, and another log is the strictest: of
several logs each is held out in turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ...study.engine.limits import Limits
from ...study.engine.open_engine import open_engine
from ...study.engine.task import Beat, Inputs
from ..design import design_of
from ..estimate import Estimate, Model, estimate
from ..fit_frames import Sample
from ..sampling.sampler import SamplerOptions
from ..terms import Term
from .posterior_predictive import Draws

BLOCK = 25  # frames
FOLDS = 5
SPLITS = ("blocks", "halves", "interleaved", "leave-one-out", "logs")

_FEW = 40  # frames, below which each is left out in turn
_MOST_ROWS = 20_000
_GOOD_PCT = 3.0  # mean error, up to which no reason is looked for
_LEAST_COVERED = 0.8  # more than 90 % is no fault: frames of one log share its slow states
_UNFIT_MEAN_PCT, _UNFIT_SD_PCT = 10.0, 40.0  # twice what the worst of measured logs had
_UNFIT_COVERAGE = 0.6
_STEPS = 1_000  # of a chain for one fold: 32 walkers leave some 500 independent samples
_WEIGHED, _KEPT = 4_000, 1_000  # samples
_ENOUGH = 0.1  # of the weighted samples, effective ones
_SAMPLE = "sample"
_PATIENT = Limits(timeout_s=1e7)  # a chain is as long as it has to be
_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Errors of prediction over measurement minus one, in per cent.

    Attributes
    ----------
    split : how frames were held out, one of `SPLITS`, or the name of another log
    rows : frames predicted
    error_pct_mean, error_pct_sd : mean and standard deviation
    error_pct_quantiles : at 5, 25, 50, 75 and 95 %
    coverage_90 : share of frames inside their 90 % predictive interval
    log_score : mean log predictive density of a frame, in nats
    open_pct : deviation of the mean error over posterior samples: what the fit leaves open
    reason : why the prediction is off, if it is, one sentence
    folds : parts that were held out in turn
    error_pct_mean_se : standard error of the mean, over blocks or logs; 0 where there is but one
    """

    split: str
    rows: int
    error_pct_mean: float
    error_pct_sd: float
    error_pct_quantiles: tuple[float, ...]
    coverage_90: float
    log_score: float
    open_pct: float = 0.0
    reason: str = ""
    folds: int = 1
    error_pct_mean_se: float = 0.0

    @property
    def unfit(self) -> str:
        """Why the model is not to be used for other frames, in words; empty where it is."""
        if abs(self.error_pct_mean) > max(_UNFIT_MEAN_PCT, 2.0 * self.error_pct_mean_se):
            return f"the mean error is {self.error_pct_mean:+.1f} %, over {_UNFIT_MEAN_PCT:g} %"
        if self.error_pct_sd > _UNFIT_SD_PCT:
            return f"errors scatter by {self.error_pct_sd:.0f} %, over {_UNFIT_SD_PCT:g} %"
        if self.coverage_90 < _UNFIT_COVERAGE:
            return f"90 % intervals hold {self.coverage_90:.0%}, less than {_UNFIT_COVERAGE:.0%}"
        return ""


def block_numbers(
    series: NDArray[np.int64], path: NDArray[np.int64] | None = None
) -> NDArray[np.int64]:
    """Return for each frame which block of its log it is in; no block has frames of two logs.

    Parameters
    ----------
    path
        Places of frames on the path; None where they are as they stand.
    """
    numbers = np.zeros(len(series), dtype=np.int64)
    start = 0
    for log in np.unique(series):
        where = np.flatnonzero(series == log)
        place = np.arange(len(where)) if path is None else path[where]
        size = max(1, min(BLOCK, (int(place.max()) + 1) // 4))
        numbers[where] = start + place // size
        start = int(numbers[where].max()) + 1
    return numbers


def folds_of(sample: Sample, split: str) -> list[BoolArray]:
    """Return which frames are held out, (n,), of each fold; none is without a frame."""
    if split == "logs":
        return [sample.series == log for log in np.unique(sample.series)]
    if split == "blocks":
        fold = block_numbers(sample.series, sample.path) % FOLDS
        return [fold == one for one in np.unique(fold)]
    return [~split_of(sample, split)]


def split_of(sample: Sample, split: str) -> BoolArray:
    """Return which frames are fitted, (n,), of interleaved ones or halves; the others are not."""
    if split == "interleaved":
        return np.arange(len(sample)) % 2 == 0
    fitted = np.zeros(len(sample), dtype=np.bool_)
    for log in np.unique(sample.series):
        where = np.flatnonzero(sample.series == log)
        fitted[where[: len(where) // 2]] = True
    return fitted


def hold_out(
    sample: Sample,
    terms: Sequence[Term],
    model: Model,
    options: SamplerOptions,
    split: str,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    whole: Estimate | None = None,
) -> HeldOut:
    """Fit to a part of the frames and predict the others, of each fold in turn.

    Raises `InputError` if the split is unknown, or either part has too few frames.

    Parameters
    ----------
    split
        One of `SPLITS`, or "auto": blocks, but each frame in turn where there are few.
    workers, scheduler
        Of the engine (see `open_engine`) for the fits of leave-one-out.
    whole
        The fit to all frames: samples of it, weighted, stand for fits without one of few frames.
    """
    if split == "auto":
        split = "leave-one-out" if len(sample) <= _FEW else "blocks"
    if split not in SPLITS:
        raise InputError(f"--heldout: expected one of {', '.join(SPLITS)}, got {split}")
    short = replace(options, max_steps=min(options.max_steps, _STEPS))
    if split != "leave-one-out":
        return _by_folds(sample, terms, model, short, split)
    if len(sample) > 10 * _FEW:
        raise InputError(
            f"--heldout leave-one-out: expected at most {10 * _FEW} frames, since each is one "
            f"fit, got {len(sample)}; use blocks"
        )
    known = {} if whole is None or len(sample) > _FEW else _reweighted(whole, sample)
    rows = [row for row in range(len(sample)) if row not in known]
    tasks = [LeftOut(row, tuple(terms), model, short) for row in rows]
    if tasks:
        found = _side_by_side(tasks, sample, workers, scheduler)
        known |= dict(zip(rows, found, strict=True))
    parts = [known[row] for row in range(len(sample))]
    return _with_error(_summary(split, parts), [frames[0] for frames, _ in parts])


def _by_folds(
    sample: Sample, terms: Sequence[Term], model: Model, options: SamplerOptions, split: str
) -> HeldOut:
    folds = folds_of(sample, split)
    fits = [
        estimate(part, varying(part, terms), model, options)
        for part in (sample.rows(~held) for held in folds)
    ]
    rest = [sample.rows(held) for held in folds]
    parts = [_predict(fit, part) for fit, part in zip(fits, rest, strict=True)]
    summary = _summary(split, parts)
    if split == "logs":
        groups = [frames[0] for frames, _ in parts]
    else:
        groups = [
            frames[0][blocks == block]
            for (frames, _), seen in zip(parts, map(_seen, rest), strict=True)
            for blocks in [block_numbers(seen.series, seen.path)]
            for block in np.unique(blocks)
        ]
    summary = _with_error(summary, groups)
    if _good(summary):
        return summary
    worst = int(np.argmax([abs(frames[0].mean()) for frames, _ in parts]))
    return replace(summary, reason=_reason(fits[worst], rest[worst], summary))


def varying(sample: Sample, terms: Sequence[Term]) -> tuple[Term, ...]:
    """Return the terms that are not the same in all frames: a knee may be beyond all of a part."""
    design = [
        (term, np.maximum(sample.column(term.predictors[0]) - term.at, 0.0))
        for term in terms
        if term.kind == "knee"
    ]
    still = {term for term, column in design if np.ptp(column) <= 1e-9 * column.mean()}
    return tuple(term for term in terms if term not in still)


def _with_error(summary: HeldOut, groups: Sequence[FloatArray]) -> HeldOut:
    """Return the summary with the standard error of its mean, over groups that err alike."""
    sizes = np.array([len(group) for group in groups], dtype=np.float64)
    away = np.array([group.mean() for group in groups]) - summary.error_pct_mean
    share = sizes / sizes.sum()
    several = len(groups) > 1
    error = np.sqrt(np.sum((share * away) ** 2) * len(groups) / (len(groups) - 1)) if several else 0
    return replace(summary, error_pct_mean_se=float(error))


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
            found[row] = _predict_by(replace(all_draws, theta=kept), whole, one)
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
        """Return what `_predict` does (see `Task`)."""
        sample: Sample = inputs[_SAMPLE]
        others = np.arange(len(sample)) != self.row

        def tell(steps: int, _most: int) -> None:
            beat(steps)

        kept = sample.rows(others)
        fitted = estimate(kept, self.terms, self.model, self.options, progress=tell)
        return _predict(fitted, sample.rows(~others))


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


def judge(fitted: Estimate, sample: Sample, name: str) -> HeldOut:
    """Return how well a fitted model predicts other frames, and the reason if it does not."""
    prediction = _predict(fitted, sample)
    summary = _summary(name, [prediction])
    return summary if _good(summary) else replace(summary, reason=_reason(fitted, sample, summary))


def _good(summary: HeldOut) -> bool:
    return abs(summary.error_pct_mean) <= _GOOD_PCT and summary.coverage_90 >= _LEAST_COVERED


def _reason(fitted: Estimate, sample: Sample, summary: HeldOut) -> str:
    """Return in words why other frames are predicted badly, as far as the frames tell."""
    mean = design_of(sample, fitted.terms, fitted.design.unit).columns.mean(axis=1)
    own = fitted.design.columns.mean(axis=1)
    names = fitted.design.names
    held = ", ".join(
        f"{there / here:.2f} times the {name}"
        for name, there, here in zip(names[1:], mean[1:], own[1:], strict=True)
    )
    left_open = f"what the fit leaves open is {summary.open_pct:.1f} %"
    if abs(summary.error_pct_mean) <= 2.0 * summary.open_pct:
        why = "so coefficients are too uncertain for this mixture of predictors"
    else:
        why = "so these frames cost what no predictor counts, or the machine ran otherwise"
    return f"frames hold {held} of the fitted ones; {left_open}, {why}"


def _predict(fitted: Estimate, sample: Sample) -> tuple[FloatArray, float]:
    """Return what there is to say of each frame, (3, n), and the deviation of the mean error.

    Of a frame: the error in per cent, whether the interval covers it, and the log density.
    """
    return _predict_by(fitted.draws, fitted, sample)


def _predict_by(draws: Draws, fitted: Estimate, sample: Sample) -> tuple[FloatArray, float]:
    sample = _seen(sample)
    design = design_of(sample, fitted.terms, fitted.design.unit)
    draws = draws.fitting(len(sample)).elsewhere(np.random.default_rng(1))
    mean, simulated = draws.simulate(design, np.random.default_rng(0))
    low, high = np.quantile(simulated, (0.05, 0.95), axis=0)
    errors = 100.0 * (mean.mean(axis=0) / sample.time_ms - 1.0)
    covered = (sample.time_ms >= low) & (sample.time_ms <= high)
    frames = np.stack((errors, covered, draws.log_density(design, sample.time_ms)))
    return frames, float((100.0 * (mean / sample.time_ms - 1.0).mean(axis=1)).std())


def _seen(sample: Sample) -> Sample:
    """Return frames, of very many some."""
    step = max(1, -(-len(sample) // _MOST_ROWS))
    return sample.rows(np.arange(0, len(sample), step))


def _summary(split: str, predictions: Sequence[tuple[FloatArray, float]]) -> HeldOut:
    errors, covered, score = np.hstack([frames for frames, _ in predictions])
    return HeldOut(
        split,
        len(errors),
        float(errors.mean()),
        float(errors.std()),
        tuple(np.quantile(errors, _QUANTILES).tolist()),
        float(covered.mean()),
        float(score.mean()),
        float(np.mean([left_open for _, left_open in predictions])),
        folds=len(predictions),
    )
