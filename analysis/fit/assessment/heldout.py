"""How well a model predicts frames that it was not fitted to.

Successive frames err alike, so a frame between two fitted ones is no test; blocks of successive
frames of the path are held out, a fifth of them at a time, so that each frame is predicted once.
Halves are the stricter test of a log whose conditions drift, and another log is the strictest: of
several logs each is held out in turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ..design import additive_column, design_of
from ..estimate import Estimate, Model, estimate
from ..fit_frames import Sample
from ..sampling.sampler import SamplerOptions
from ..terms import Term
from .leave_one_out import FEW, leave_one_out
from .prediction import predict, seen_rows

BLOCK = 25  # frames
FOLDS = 5
SPLITS = ("blocks", "halves", "interleaved", "leave-one-out", "logs")

_GOOD_PCT = 3.0  # mean error, up to which no reason is looked for
_LEAST_COVERED = 0.8  # more than 90 % is no fault: frames of one log share its slow states
_UNFIT_MEAN_PCT, _UNFIT_SD_PCT = 10.0, 40.0  # twice what the worst of measured logs had
_UNFIT_COVERAGE = 0.6
_STEPS = 1_000  # of a chain for one fold: 32 walkers leave some 500 independent samples
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
    error_pct_total : error of the time of all frames together: the mean of errors is too high where
        times scatter, as that of 1 / (1 + e) is
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
    error_pct_total: float = 0.0

    @property
    def unfit(self) -> str:
        """Why the model is not to be used for other frames, in words; empty where it is."""
        if abs(self.error_pct_total) > max(_UNFIT_MEAN_PCT, 2.0 * self.error_pct_mean_se):
            off = f"{self.error_pct_total:+.1f} %, over {_UNFIT_MEAN_PCT:g} %"
            return f"the time of all together is off by {off}"
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
        split = "leave-one-out" if len(sample) <= FEW else "blocks"
    if split not in SPLITS:
        raise InputError(f"--heldout: expected one of {', '.join(SPLITS)}, got {split}")
    short = replace(options, max_steps=min(options.max_steps, _STEPS))
    if split != "leave-one-out":
        return _by_folds(sample, terms, model, short, split)
    parts = leave_one_out(
        sample, terms, model, short, workers=workers, scheduler=scheduler, whole=whole
    )
    return _with_error(_summary(split, parts), [frames[0] for frames, _ in parts])


def _by_folds(
    sample: Sample, terms: Sequence[Term], model: Model, options: SamplerOptions, split: str
) -> HeldOut:
    folds = folds_of(sample, split)
    if any(held.all() for held in folds):
        raise InputError(
            f"--heldout {split}: expected frames of several places on the path, got all of one; "
            "use none"
        )
    fits = [
        estimate(part, varying(part, terms), model, options)
        for part in (sample.rows(~held) for held in folds)
    ]
    rest = [sample.rows(held) for held in folds]
    parts = [predict(fit, part) for fit, part in zip(fits, rest, strict=True)]
    summary = _summary(split, parts)
    if split == "logs":
        groups = [frames[0] for frames, _ in parts]
    else:
        groups = [
            frames[0][blocks == block]
            for (frames, _), seen in zip(parts, map(seen_rows, rest), strict=True)
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
    design = [(term, additive_column(sample, term)) for term in terms if term.kind == "knee"]
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


def judge(fitted: Estimate, sample: Sample, name: str) -> HeldOut:
    """Return how well a fitted model predicts other frames, and the reason if it does not."""
    prediction = predict(fitted, sample)
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


def _summary(split: str, predictions: Sequence[tuple[FloatArray, float]]) -> HeldOut:
    errors, covered, score, time_ms = np.hstack([frames for frames, _ in predictions])
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
        error_pct_total=float(np.average(errors, weights=time_ms)),
    )
