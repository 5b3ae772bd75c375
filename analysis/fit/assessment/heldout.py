"""How well a model predicts frames that it was not fitted to.

Successive frames err alike, so a frame between two fitted ones is no test; blocks of successive
frames are held out.  Halves are the stricter test of a log whose conditions drift, and another log
is the strictest.
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

BLOCK = 25  # frames
SPLITS = ("blocks", "halves", "interleaved", "leave-one-out")

_FEW = 40  # frames, below which each is left out in turn
_MOST_ROWS = 20_000
_GOOD_PCT = 3.0  # mean error, up to which no reason is looked for
_COVERED = (0.8, 0.97)
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


def block_numbers(series: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return for each frame which block of its log it is in; no block has frames of two logs."""
    numbers = np.zeros(len(series), dtype=np.int64)
    start = 0
    for log in np.unique(series):
        where = np.flatnonzero(series == log)
        size = max(1, min(BLOCK, len(where) // 4))
        numbers[where] = start + np.arange(len(where)) // size
        start = int(numbers[where].max()) + 1
    return numbers


def split_of(sample: Sample, split: str) -> BoolArray:
    """Return which frames are fitted, (n,); the others are held out."""
    if split == "interleaved":
        return np.arange(len(sample)) % 2 == 0
    if split == "blocks":
        return block_numbers(sample.series) % 2 == 0
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
) -> HeldOut:
    """Fit to a part of the frames and predict the others.

    Raises `InputError` if the split is unknown, or either part has too few frames.

    Parameters
    ----------
    split
        One of `SPLITS`, or "auto": blocks, but each frame in turn where there are few.
    workers, scheduler
        Of the engine (see `open_engine`) for the fits of leave-one-out.
    """
    if split == "auto":
        split = "leave-one-out" if len(sample) <= _FEW else "blocks"
    if split not in SPLITS:
        raise InputError(f"--heldout: expected one of {', '.join(SPLITS)}, got {split}")
    if split != "leave-one-out":
        fitted = split_of(sample, split)
        part = estimate(sample.rows(fitted), terms, model, options)
        return judge(part, sample.rows(~fitted), split)
    if len(sample) > 10 * _FEW:
        raise InputError(
            f"--heldout leave-one-out: expected at most {10 * _FEW} frames, since each is one "
            f"fit, got {len(sample)}; use blocks"
        )
    tasks = [LeftOut(row, tuple(terms), model, options) for row in range(len(sample))]
    return _summary(split, _side_by_side(tasks, sample, workers, scheduler))


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
    good = (
        abs(summary.error_pct_mean) <= _GOOD_PCT
        and _COVERED[0] <= summary.coverage_90 <= _COVERED[1]
    )
    return summary if good else replace(summary, reason=_reason(fitted, sample, summary))


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
    step = max(1, -(-len(sample) // _MOST_ROWS))
    sample = sample.rows(np.arange(0, len(sample), step))
    design = design_of(sample, fitted.terms, fitted.design.unit)
    draws = fitted.draws.fitting(len(sample))
    mean, simulated = draws.simulate(design, np.random.default_rng(0))
    low, high = np.quantile(simulated, (0.05, 0.95), axis=0)
    errors = 100.0 * (mean.mean(axis=0) / sample.time_ms - 1.0)
    covered = (sample.time_ms >= low) & (sample.time_ms <= high)
    frames = np.stack((errors, covered, draws.log_density(design, sample.time_ms)))
    return frames, float((100.0 * (mean / sample.time_ms - 1.0).mean(axis=1)).std())


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
    )
